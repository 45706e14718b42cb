//! Rigid bodies under gravity (rapier3d).
//!
//! A body is known by its handle; poses are `world_from_body`. Cloning gives a
//! world that goes on exactly as this one does.

use crate::glam_conversion::{pose_from_glam, pose_to_glam, vector_from_glam, vector_to_glam};
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use rapier3d::math::Vector;
use rapier3d::prelude::{
    BroadPhaseBvh, CCDSolver, Collider, ColliderBuilder, ColliderHandle, ColliderSet, Group,
    ImpulseJointSet, IntegrationParameters, InteractionGroups, InteractionTestMode, IslandManager,
    MultibodyJointSet, NarrowPhase, PhysicsPipeline, QueryFilter, Ray, RigidBody, RigidBodyBuilder,
    RigidBodyHandle, RigidBodySet, RigidBodyType, SharedShape, SoftBodySet,
};

/// Steps of the physics in a second.
pub const STEPS_PER_SECOND: u32 = 120;
/// One step, nanoseconds, rounded down.
pub const STEP_NS: u64 = 1_000_000_000 / STEPS_PER_SECOND as u64;

/// Metres in which the engine's tolerances are counted: objects are some
/// centimetres large.
const LENGTH_UNIT_M: f32 = 0.1;
/// A body slower than this for half a second sleeps, m/s and rad/s. It stands in
/// for the rolling friction that the engine lacks: round hulls would tremble for ever.
const SLEEP_M_S: f32 = 0.05;
const SLEEP_RAD_S: f32 = 1.0;
/// Slower than this is at rest, m/s and rad/s.
const REST_M_S: f64 = 0.01;
const REST_RAD_S: f64 = 0.15;

/// Linear and angular damping of an object, 1/s. Rolling friction is not
/// modelled; damping keeps balls on the table.
const DAMPING: (f32, f32) = (0.4, 4.0);
/// Damping of an object that rocks or trembles on the corners of its convex parts.
const CALMING: (f32, f32) = (60.0, 120.0);
/// An object that gets less far than this in half a second rocks or trembles,
/// metres and radians.
const CALM_M: f64 = 0.008;
const CALM_RAD: f64 = 0.10;
const CALMING_STEPS: u32 = STEPS_PER_SECOND / 2;

fn is_nearly(a: &RigidTransform, b: &RigidTransform) -> bool {
    let moved_m = (a.translation.vector - b.translation.vector).norm();
    moved_m < CALM_M && a.rotation.angle_to(&b.rotation) < CALM_RAD
}

fn set_damping(body: &mut RigidBody, (linear, angular): (f32, f32)) {
    body.set_linear_damping(linear);
    body.set_angular_damping(angular);
}

/// What a body collides with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Table, floor, walls.
    Fixture,
    /// An object.
    Object,
    /// A moved body that pushes objects: the arm.
    Arm,
}

impl Kind {
    fn group(self) -> Group {
        match self {
            Self::Fixture => Group::GROUP_1,
            Self::Object => Group::GROUP_2,
            Self::Arm => Group::GROUP_3,
        }
    }

    fn groups(self) -> InteractionGroups {
        let partners = match self {
            Self::Object => Group::GROUP_1 | Group::GROUP_2 | Group::GROUP_3,
            Self::Fixture | Self::Arm => Group::GROUP_2,
        };
        InteractionGroups::new(self.group(), partners, InteractionTestMode::And)
    }
}

/// One body of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct BodyId(RigidBodyHandle);

/// All bodies and what the engine remembers between steps.
pub(crate) struct Physics {
    parameters: IntegrationParameters,
    pipeline: PhysicsPipeline,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    ccd: CCDSolver,
    n_steps: u32,
    /// Where the objects were when it was last looked whether they get anywhere.
    seen_at: Vec<(RigidBodyHandle, RigidTransform)>,
}

impl Clone for Physics {
    fn clone(&self) -> Self {
        Self {
            parameters: self.parameters,
            // A workspace, not a state.
            pipeline: PhysicsPipeline::new(),
            islands: self.islands.clone(),
            broad_phase: self.broad_phase.clone(),
            narrow_phase: self.narrow_phase.clone(),
            bodies: self.bodies.clone(),
            colliders: self.colliders.clone(),
            impulse_joints: self.impulse_joints.clone(),
            multibody_joints: self.multibody_joints.clone(),
            soft_bodies: self.soft_bodies.clone(),
            ccd: CCDSolver::new(),
            n_steps: self.n_steps,
            seen_at: self.seen_at.clone(),
        }
    }
}

impl std::fmt::Debug for Physics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let n_bodies = self.bodies.len();
        f.debug_struct("Physics")
            .field("n_bodies", &n_bodies)
            .finish_non_exhaustive()
    }
}

impl Physics {
    pub(crate) fn new() -> Self {
        let mut parameters = IntegrationParameters {
            length_unit: LENGTH_UNIT_M,
            // Both save time where much is at rest, and make bodies of many convex
            // parts tremble for ever: plates, pots and cutlery never came to rest.
            contact_recycling: false,
            contact_clustering: false,
            ..IntegrationParameters::default()
        };
        parameters.static_contact_softness = parameters.contact_softness;
        parameters.set_inv_dt(STEPS_PER_SECOND as f32);
        Self {
            parameters,
            pipeline: PhysicsPipeline::new(),
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::default(),
            narrow_phase: NarrowPhase::new(),
            bodies: RigidBodySet::new(),
            colliders: ColliderSet::new(),
            impulse_joints: ImpulseJointSet::new(),
            multibody_joints: MultibodyJointSet::new(),
            soft_bodies: SoftBodySet::new(),
            ccd: CCDSolver::new(),
            n_steps: 0,
            seen_at: Vec::new(),
        }
    }

    /// Adds what never moves: a box given by its pose and half sides.
    pub(crate) fn add_fixture(&mut self, pose: &RigidTransform, half_sides_m: &Vector3<f64>) {
        let half = vector_to_glam(half_sides_m);
        self.insert(
            RigidBodyBuilder::fixed().pose(pose_to_glam(pose)).build(),
            ColliderBuilder::cuboid(half.x, half.y, half.z)
                .friction(0.6)
                .collision_groups(Kind::Fixture.groups())
                .build(),
        );
    }

    /// Adds an object; `friction` is Coulomb's coefficient.
    pub(crate) fn add_object(
        &mut self,
        shape: &SharedShape,
        mass_kg: f64,
        friction: f64,
        pose: &RigidTransform,
    ) -> BodyId {
        let body = RigidBodyBuilder::dynamic()
            .pose(pose_to_glam(pose))
            .linear_damping(DAMPING.0)
            .angular_damping(DAMPING.1)
            .ccd_enabled(true);
        let collider = ColliderBuilder::new(shape.clone())
            .mass(mass_kg as f32)
            .friction(friction as f32)
            .restitution(0.0)
            .collision_groups(Kind::Object.groups());
        let body = self.insert(body.build(), collider.build());
        if let Some(body) = self.bodies.get_mut(body.0) {
            let activation = body.activation_mut();
            activation.normalized_linear_threshold = SLEEP_M_S / LENGTH_UNIT_M;
            activation.angular_threshold = SLEEP_RAD_S;
        }
        body
    }

    /// Adds a body that goes where it is told and pushes objects.
    pub(crate) fn add_moved(&mut self, shape: &SharedShape, pose: &RigidTransform) -> BodyId {
        self.insert(
            RigidBodyBuilder::kinematic_position_based()
                .pose(pose_to_glam(pose))
                .build(),
            ColliderBuilder::new(shape.clone())
                .friction(0.8)
                .collision_groups(Kind::Arm.groups())
                .build(),
        )
    }

    fn insert(&mut self, body: RigidBody, collider: Collider) -> BodyId {
        let handle = self.bodies.insert(body);
        self.colliders
            .insert_with_parent(collider, handle, &mut self.bodies);
        BodyId(handle)
    }

    /// Takes a body out of the world.
    pub(crate) fn remove(&mut self, body: BodyId) {
        self.bodies.remove(
            body.0,
            &mut self.islands,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            true,
        );
    }

    /// Advances by one step.
    pub(crate) fn step(&mut self) {
        self.pipeline.step(
            Vector::new(0.0, 0.0, -9.81),
            &self.parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd,
            &(),
            &(),
        );
        self.n_steps += 1;
        if self.n_steps.is_multiple_of(CALMING_STEPS) {
            self.calm();
        }
    }

    /// Brakes objects that move and get nowhere, until they sleep or get away.
    fn calm(&mut self) {
        let mut seen_at = Vec::with_capacity(self.seen_at.len());
        for (handle, body) in self.bodies.iter_mut() {
            if !body.is_dynamic() {
                continue;
            }
            if body.is_sleeping() {
                set_damping(body, DAMPING);
                continue;
            }
            let pose = pose_from_glam(body.position());
            let before = self.seen_at.iter().find(|(seen, _)| *seen == handle);
            let is_calm = before.is_some_and(|(_, before)| is_nearly(before, &pose));
            set_damping(body, if is_calm { CALMING } else { DAMPING });
            seen_at.push((handle, pose));
        }
        self.seen_at = seen_at;
    }

    /// Where a moved or held body will be at the end of the next step.
    pub(crate) fn move_to(&mut self, body: BodyId, pose: &RigidTransform) {
        if let Some(body) = self.bodies.get_mut(body.0) {
            body.set_next_kinematic_position(pose_to_glam(pose));
        }
    }

    /// Puts a body somewhere at once, at rest.
    pub(crate) fn place(&mut self, body: BodyId, pose: &RigidTransform) {
        if let Some(body) = self.bodies.get_mut(body.0) {
            body.set_position(pose_to_glam(pose), true);
            body.set_linvel(Vector::ZERO, true);
            body.set_angvel(Vector::ZERO, true);
        }
    }

    /// Whether an object follows a hand instead of gravity.
    pub(crate) fn set_held(&mut self, body: BodyId, is_held: bool) {
        let kind = if is_held {
            RigidBodyType::KinematicPositionBased
        } else {
            RigidBodyType::Dynamic
        };
        if let Some(body) = self.bodies.get_mut(body.0) {
            body.set_body_type(kind, true);
            set_damping(body, DAMPING);
            body.set_linvel(Vector::ZERO, true);
            body.set_angvel(Vector::ZERO, true);
        }
    }

    /// `world_from_body`; the identity for a body that is not there.
    pub(crate) fn pose(&self, body: BodyId) -> RigidTransform {
        self.bodies
            .get(body.0)
            .map_or_else(RigidTransform::identity, |body| {
                pose_from_glam(body.position())
            })
    }

    /// Velocity of the origin in m/s and angular velocity in rad/s, world frame.
    pub(crate) fn velocity(&self, body: BodyId) -> (Vector3<f64>, Vector3<f64>) {
        self.bodies.get(body.0).map_or_else(
            || (Vector3::zeros(), Vector3::zeros()),
            |body| {
                (
                    vector_from_glam(body.velocity_at_point(body.translation())),
                    vector_from_glam(body.angvel()),
                )
            },
        )
    }

    /// Whether a body lies still.
    pub(crate) fn is_at_rest(&self, body: BodyId) -> bool {
        let sleeps = self.bodies.get(body.0).is_some_and(RigidBody::is_sleeping);
        let (linear, angular) = self.velocity(body);
        sleeps || (linear.norm() < REST_M_S && angular.norm() < REST_RAD_S)
    }

    /// Force with which a moved body presses on objects, newtons, over the last step.
    pub(crate) fn pressing_n(&self, body: BodyId) -> f64 {
        let impulses = self.colliders_of(body).flat_map(|collider| {
            self.narrow_phase
                .contact_pairs_with(collider)
                .map(rapier3d::prelude::ContactPair::total_impulse_magnitude)
        });
        f64::from(impulses.sum::<f32>()) * f64::from(STEPS_PER_SECOND)
    }

    /// The objects a moved body touches.
    pub(crate) fn touched_by(&self, body: BodyId) -> impl Iterator<Item = BodyId> {
        self.colliders_of(body).flat_map(move |collider| {
            let pairs = self.narrow_phase.contact_pairs_with(collider);
            pairs
                .filter(|pair| pair.has_any_active_contact())
                .filter_map(move |pair| {
                    let other = if pair.collider1 == collider {
                        pair.collider2
                    } else {
                        pair.collider1
                    };
                    self.colliders.get(other)?.parent().map(BodyId)
                })
        })
    }

    fn colliders_of(&self, body: BodyId) -> impl Iterator<Item = ColliderHandle> {
        self.bodies
            .get(body.0)
            .into_iter()
            .flat_map(|body| body.colliders().iter().copied())
    }

    /// Whether a shape at a pose would reach into table, floor or walls.
    pub(crate) fn hits_fixture(&self, shape: &SharedShape, pose: &RigidTransform) -> bool {
        let fixtures = Kind::Fixture.group();
        let groups = InteractionGroups::new(Group::ALL, fixtures, InteractionTestMode::And);
        let query = self.broad_phase.as_query_pipeline(
            self.narrow_phase.query_dispatcher(),
            &self.bodies,
            &self.colliders,
            QueryFilter::new().groups(groups),
        );
        let pose = pose_to_glam(pose);
        query.intersect_shape(pose, &**shape).next().is_some()
    }

    /// Outward normal of a body's surface where a ray of at most `reach_m` meets
    /// it from outside.
    pub(crate) fn surface_along(
        &self,
        body: BodyId,
        from: &Point3<f64>,
        direction: &Vector3<f64>,
        reach_m: f64,
    ) -> Option<Vector3<f64>> {
        let ray = Ray::new(vector_to_glam(&from.coords), vector_to_glam(direction));
        self.colliders_of(body)
            .filter_map(|handle| {
                let collider = self.colliders.get(handle)?;
                let (shape, pose) = (collider.shape(), collider.position());
                shape.cast_ray_and_get_normal(pose, &ray, reach_m as f32, false)
            })
            .min_by(|a, b| a.time_of_impact.total_cmp(&b.time_of_impact))
            .map(|hit| vector_from_glam(hit.normal))
    }
}
