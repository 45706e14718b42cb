//! Rigid body physics under gravity (rapier3d).
//!
//! Bodies are identified by handles; poses are `world_from_body`. A clone continues exactly as
//! the original does.

use crate::glam_conversion::{pose_from_glam, pose_to_glam, vector_from_glam, vector_to_glam};
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};
use rapier3d::math::Vector;
use rapier3d::parry::query::ShapeCastOptions;
use rapier3d::prelude::{
    BroadPhaseBvh, CCDSolver, CoefficientCombineRule, Collider, ColliderBuilder, ColliderHandle,
    ColliderSet, Group, ImpulseJointSet, IntegrationParameters, InteractionGroups,
    InteractionTestMode, IslandManager, MultibodyJointSet, NarrowPhase, PhysicsPipeline,
    QueryFilter, Ray, RigidBody, RigidBodyBuilder, RigidBodyHandle, RigidBodySet, RigidBodyType,
    SharedShape, SoftBodySet,
};

/// Number of physics steps per second.
pub const STEPS_PER_SECOND: u32 = 120;
/// Duration of one step, nanoseconds, rounded down.
pub const STEP_NS: u64 = 1_000_000_000 / STEPS_PER_SECOND as u64;

/// Length unit of the engine's tolerances, metres; objects are a few centimetres large.
const LENGTH_UNIT_M: f32 = 0.1;
/// Gap below which two bodies touch, metres: below half of a finger's way in a step.
const TOUCHING_M: f32 = 0.0002;
/// Sleep threshold of linear velocity, m/s: a body that is slower for half a second falls asleep.
/// It replaces rolling friction, which the engine lacks; round hulls would tremble forever.
/// Chosen.
const SLEEP_M_S: f32 = 0.05;
/// Sleep threshold of angular velocity, rad/s. Chosen.
const SLEEP_RAD_S: f32 = 1.0;
/// Rest threshold of linear velocity, m/s. Chosen.
const REST_M_S: f64 = 0.01;
/// Rest threshold of angular velocity, rad/s. Chosen.
const REST_RAD_S: f64 = 0.15;

/// Linear and angular damping of an object, 1/s. Rolling friction is not modelled; damping keeps
/// balls on the table. Chosen.
const DAMPING: (f32, f32) = (0.4, 4.0);
/// Linear and angular damping of an object that jitters on the corners of its convex parts, 1/s.
/// Chosen.
const JITTER_DAMPING: (f32, f32) = (60.0, 120.0);
/// Jitter threshold of translation: an object that moves less in half a second jitters, metres.
/// Chosen.
const JITTER_M: f64 = 0.008;
/// Jitter threshold of rotation, radians. Chosen.
const JITTER_RAD: f64 = 0.10;
/// Number of iterations of the contact solver for stacks; 4 otherwise. Chosen.
const STACK_ITERATIONS: usize = 8;
/// Natural frequency of contacts in stacks, hertz; 30 otherwise. Chosen.
const STACK_FREQUENCY_HZ: f32 = 60.0;
/// Interval of the jitter checks, steps. Chosen.
const JITTER_CHECK_STEPS: u32 = STEPS_PER_SECOND / 2;

fn is_nearly(a: &RigidTransform, b: &RigidTransform) -> bool {
    let moved_m = (a.translation.vector - b.translation.vector).norm();
    moved_m < JITTER_M && a.rotation.angle_to(&b.rotation) < JITTER_RAD
}

fn set_damping(body: &mut RigidBody, (linear, angular): (f32, f32)) {
    body.set_linear_damping(linear);
    body.set_angular_damping(angular);
}

/// Collision group of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CollisionGroup {
    /// Collision group of fixed bodies: table, floor, walls.
    Fixture,
    /// Collision group of dynamic objects.
    Object,
    /// Collision group of kinematic bodies that push objects: the arm.
    Arm,
}

impl CollisionGroup {
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

/// Handle of a rigid body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct BodyId(RigidBodyHandle);

/// Physics world: bodies and the state of the engine.
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
    /// Poses of the moving objects at the last jitter check.
    last_poses: Vec<(RigidBodyHandle, RigidTransform)>,
}

impl Clone for Physics {
    fn clone(&self) -> Self {
        Self {
            parameters: self.parameters,
            // A workspace without state.
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
            last_poses: self.last_poses.clone(),
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
            // Both save time when many bodies are at rest, but make bodies of many convex parts
            // tremble forever: plates, pots and cutlery never came to rest.
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
            last_poses: Vec::new(),
        }
    }

    /// Makes contacts stiffer for stacks, at the price of slower steps: heavy objects sink less
    /// into light ones below them.
    pub(crate) fn stiffen_stacks(&mut self) {
        self.parameters.num_solver_iterations = STACK_ITERATIONS;
        for softness in [
            &mut self.parameters.contact_softness,
            &mut self.parameters.static_contact_softness,
        ] {
            softness.natural_frequency = STACK_FREQUENCY_HZ;
        }
    }

    /// Adds a fixed box, given by its pose and half sides.
    pub(crate) fn add_fixture(&mut self, pose: &RigidTransform, half_sides_m: &Vector3<f64>) {
        let half = vector_to_glam(half_sides_m);
        self.insert(
            RigidBodyBuilder::fixed().pose(pose_to_glam(pose)).build(),
            ColliderBuilder::cuboid(half.x, half.y, half.z)
                .friction(0.6)
                .collision_groups(CollisionGroup::Fixture.groups())
                .build(),
        );
    }

    /// Adds a dynamic object; `friction` is the Coulomb coefficient.
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
            .collision_groups(CollisionGroup::Object.groups());
        let body = self.insert(body.build(), collider.build());
        if let Some(body) = self.bodies.get_mut(body.0) {
            let activation = body.activation_mut();
            activation.normalized_linear_threshold = SLEEP_M_S / LENGTH_UNIT_M;
            activation.angular_threshold = SLEEP_RAD_S;
        }
        body
    }

    /// Adds a kinematic body, which follows given poses and pushes objects; `friction` is that
    /// between it and any object.
    pub(crate) fn add_kinematic(
        &mut self,
        shape: &SharedShape,
        friction: f64,
        pose: &RigidTransform,
    ) -> BodyId {
        self.insert(
            RigidBodyBuilder::kinematic_position_based()
                .pose(pose_to_glam(pose))
                .build(),
            ColliderBuilder::new(shape.clone())
                .friction(friction as f32)
                .friction_combine_rule(CoefficientCombineRule::Min)
                .collision_groups(CollisionGroup::Arm.groups())
                .build(),
        )
    }

    fn insert(&mut self, body: RigidBody, collider: Collider) -> BodyId {
        let handle = self.bodies.insert(body);
        self.colliders
            .insert_with_parent(collider, handle, &mut self.bodies);
        BodyId(handle)
    }

    /// Removes a rigid body from the physics world.
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

    /// Advances the physics by one step.
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
        if self.n_steps.is_multiple_of(JITTER_CHECK_STEPS) {
            self.damp_jitter();
        }
    }

    /// Damps jitter: brakes objects that move without getting anywhere, until they sleep or get
    /// away.
    fn damp_jitter(&mut self) {
        let mut last_poses = Vec::with_capacity(self.last_poses.len());
        for (handle, body) in self.bodies.iter_mut() {
            if !body.is_dynamic() {
                continue;
            }
            if body.is_sleeping() {
                set_damping(body, DAMPING);
                continue;
            }
            let pose = pose_from_glam(body.position());
            let before = self.last_poses.iter().find(|(seen, _)| *seen == handle);
            let is_jittering = before.is_some_and(|(_, before)| is_nearly(before, &pose));
            set_damping(
                body,
                if is_jittering {
                    JITTER_DAMPING
                } else {
                    DAMPING
                },
            );
            last_poses.push((handle, pose));
        }
        self.last_poses = last_poses;
    }

    /// Sets the pose of a kinematic or held body at the end of the next step.
    pub(crate) fn move_to(&mut self, body: BodyId, pose: &RigidTransform) {
        if let Some(body) = self.bodies.get_mut(body.0) {
            body.set_next_kinematic_position(pose_to_glam(pose));
        }
    }

    /// Teleports a body to a pose, at rest.
    pub(crate) fn place(&mut self, body: BodyId, pose: &RigidTransform) {
        if let Some(body) = self.bodies.get_mut(body.0) {
            body.set_position(pose_to_glam(pose), true);
            body.set_linvel(Vector::ZERO, true);
            body.set_angvel(Vector::ZERO, true);
        }
    }

    /// Switches an object between a kinematic body that follows a hand and a dynamic body.
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

    /// Pose of a body, `world_from_body`; the identity for an unknown body.
    pub(crate) fn pose(&self, body: BodyId) -> RigidTransform {
        self.bodies
            .get(body.0)
            .map_or_else(RigidTransform::identity, |body| {
                pose_from_glam(body.position())
            })
    }

    /// Centre of mass in the frame of a body, metres, and its mass, kilograms.
    pub(crate) fn mass_in_body(&self, body: BodyId) -> (Point3<f64>, f64) {
        self.bodies
            .get(body.0)
            .map_or((Point3::origin(), 0.0), |body| {
                let mass = body.mass_properties().local_mprops;
                (vector_from_glam(mass.local_com).into(), mass.mass().into())
            })
    }

    /// Velocity of the origin, m/s, and angular velocity, rad/s, world frame.
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

    /// True if a body is at rest.
    pub(crate) fn is_at_rest(&self, body: BodyId) -> bool {
        let sleeps = self.bodies.get(body.0).is_some_and(RigidBody::is_sleeping);
        let (linear, angular) = self.velocity(body);
        sleeps || (linear.norm() < REST_M_S && angular.norm() < REST_RAD_S)
    }

    /// Contact force of a kinematic body on objects over the last step, newtons.
    pub(crate) fn contact_force_n(&self, body: BodyId) -> f64 {
        let impulses = self.colliders_of(body).flat_map(|collider| {
            self.narrow_phase
                .contact_pairs_with(collider)
                .map(rapier3d::prelude::ContactPair::total_impulse_magnitude)
        });
        f64::from(impulses.sum::<f32>()) * f64::from(STEPS_PER_SECOND)
    }

    /// Objects that touch a kinematic body.
    pub(crate) fn contacts_of(&self, body: BodyId) -> impl Iterator<Item = BodyId> {
        self.contacts_within(body, TOUCHING_M)
    }

    /// Objects into which a kinematic body presses by a depth, metres.
    pub(crate) fn pressed_by(&self, body: BodyId, depth_m: f64) -> impl Iterator<Item = BodyId> {
        self.contacts_within(body, -depth_m as f32)
    }

    /// Objects nearer to a kinematic body than a distance, metres; negative inside.
    fn contacts_within(&self, body: BodyId, distance_m: f32) -> impl Iterator<Item = BodyId> {
        self.colliders_of(body).flat_map(move |collider| {
            let pairs = self.narrow_phase.contact_pairs_with(collider);
            pairs
                .filter(move |pair| {
                    // The solver also predicts contacts, over gaps of millimetres.
                    let deepest = pair.find_deepest_contact();
                    deepest.is_some_and(|(_, contact)| contact.dist < distance_m)
                })
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

    /// True if a shape at a pose would intersect table, floor or walls.
    pub(crate) fn intersects_fixture(&self, shape: &SharedShape, pose: &RigidTransform) -> bool {
        let fixtures = CollisionGroup::Fixture.group();
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

    /// Distance that a shape can move straight down from a pose before it touches something,
    /// metres, at most `reach_m`.
    pub(crate) fn clearance_below_m(
        &self,
        shape: &SharedShape,
        pose: &RigidTransform,
        reach_m: f64,
    ) -> f64 {
        let query = self.broad_phase.as_query_pipeline(
            self.narrow_phase.query_dispatcher(),
            &self.bodies,
            &self.colliders,
            QueryFilter::new(),
        );
        let options = ShapeCastOptions::with_max_time_of_impact(reach_m as f32);
        let down = Vector::new(0.0, 0.0, -1.0);
        query
            .cast_shape(&pose_to_glam(pose), down, &**shape, options)
            .map_or(reach_m, |(_, hit)| f64::from(hit.time_of_impact))
    }

    /// Ray cast: distance to a body's surface, metres, and its outward normal, at the first hit
    /// within `reach_m`, from outside.
    pub(crate) fn surface_along_ray(
        &self,
        body: BodyId,
        from: &Point3<f64>,
        direction: &Vector3<f64>,
        reach_m: f64,
    ) -> Option<(f64, Vector3<f64>)> {
        let ray = Ray::new(vector_to_glam(&from.coords), vector_to_glam(direction));
        self.colliders_of(body)
            .filter_map(|handle| {
                let collider = self.colliders.get(handle)?;
                let (shape, pose) = (collider.shape(), collider.position());
                shape.cast_ray_and_get_normal(pose, &ray, reach_m as f32, false)
            })
            .min_by(|a, b| a.time_of_impact.total_cmp(&b.time_of_impact))
            .map(|hit| (hit.time_of_impact.into(), vector_from_glam(hit.normal)))
    }
}
