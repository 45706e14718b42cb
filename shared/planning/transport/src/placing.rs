//! Placing: free poses in an area where a held object stands as it stood, and the way down to them.

use crate::arm_collision::{ArmCollision, grown_box};
use crate::carried_load::{CarriedLoad, upright_box};
use crate::place_area::PlaceArea;
use crate::place_candidates::{PlaceCandidate, place_candidates};
use crate::place_plan::PlacePlan;
use crate::place_rejection::PlaceRejection;
use arm_kinematics::{JointVector, LineTrajectory};
use geometry::{ConvexPolygon, OrientedBox, RigidTransform};
use grasping::{
    ContactPoint, Grasp, GraspScene, Obstacles, PlacedArm, SpaceState, hand_boxes, swept_back,
};
use nalgebra::{Point2, Point3, Translation3, Vector3};

/// Height over the surface at which the fingers open, metres.
pub const RELEASE_M: f64 = 0.004;
/// Length of the straight ways down and back, metres.
const WAY_M: f64 = 0.10;
/// Distance that the object keeps from what stands beside it, metres. Chosen: the hidden side is
/// estimated.
const CLEARANCE_M: f64 = 0.015;
/// Distance that the object keeps from the rim of the surface, metres.
const RIM_M: f64 = 0.015;
/// Share of the place that may be unseen.
const UNSEEN_MAX: f64 = 0.25;
/// Distance between the places that are asked whether they are seen, metres.
const SEEN_STEP_M: f64 = 0.02;
/// Number of candidates whose ways are tested with the whole arm.
const N_REACH_MAX: usize = 60;
/// Number of places after which the search ends.
const N_WANTED: usize = 3;
/// Share of the joints' speed at which the lines are planned; it changes no place on them.
const SPEED: f64 = 0.5;
/// Number of places of a line at which the whole arm is tested.
const N_LINE_STEPS: usize = 8;

/// Planner of places in a scene.
#[derive(Clone, Copy)]
pub struct PlacingPlanner<'a> {
    /// Scene, with the object where it stood.
    pub scene: &'a GraspScene<'a>,
    /// Obstacles within the arm's reach.
    pub obstacles: &'a Obstacles,
    /// Arm.
    pub placed: &'a PlacedArm,
}

/// Object as it stood when it was grasped.
#[derive(Debug, Clone, Copy)]
pub struct GraspedObject<'a> {
    /// Index in the scene.
    pub index: usize,
    /// Its surface, frame of planning.
    pub contacts: &'a [ContactPoint],
    /// Grasp by which it is held.
    pub grasp: &'a Grasp,
}

/// Place at which an object is set down, and the way to it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacePose {
    /// Pose of the tool when the fingers open.
    pub plan_from_tool: RigidTransform,
    /// Middle of the object's foot.
    pub foot: Point3<f64>,
    /// Turn about the vertical against how it stood, radians.
    pub turn_rad: f64,
    /// Length of the straight ways down and back, metres.
    pub way_m: f64,
    /// Distance between the pads after the release, metres.
    pub opening_m: f64,
    /// Name of the surface on which it stands.
    pub surface: String,
    /// Joint angles over the place, radians.
    pub above_rad: JointVector,
    /// Joint angles when the fingers open, radians.
    pub release_rad: JointVector,
    /// Joint angles after the straight way back along the tool, radians.
    pub retreat_rad: JointVector,
}

/// Pose over the area where nothing is in the way of object and hand.
struct FreePose {
    /// Pose of the tool when the fingers open.
    plan_from_tool: RigidTransform,
    /// Middle of the object's foot.
    foot: Point3<f64>,
    /// Turn about the vertical, radians.
    turn_rad: f64,
    /// Index of the surface on which the object stands.
    surface: usize,
}

/// Held object with its shape, before it is moved to a place.
struct Held<'a> {
    object: GraspedObject<'a>,
    /// Upright box around it as it stood.
    body: OrientedBox,
    /// Corners of its outline from above, relative to the middle of the box.
    outline: Vec<Point2<f64>>,
    /// Height of what it stood on.
    foot_m: f64,
    load: CarriedLoad,
}

impl PlacingPlanner<'_> {
    /// Plans places for an object in an area.
    pub fn plan(&self, object: &GraspedObject<'_>, area: &PlaceArea) -> PlacePlan {
        let mut plan = PlacePlan::default();
        let Some(held) = self.held(object) else {
            return plan;
        };
        let base = Point2::from(self.placed.plan_from_base.translation.vector.xy());
        let mut n_reached = 0;
        for candidate in place_candidates(&area.outline, &base) {
            match self.checked(&held, area, &candidate) {
                Ok(found) => {
                    n_reached += 1;
                    match self.reached(&held, &found) {
                        Ok(placement) => plan.placements.push(placement),
                        Err(reason) => plan.rejected.push(reason),
                    }
                }
                Err(reason) => plan.rejected.push(reason),
            }
            if plan.placements.len() >= N_WANTED || n_reached >= N_REACH_MAX {
                break;
            }
        }
        plan
    }

    fn held<'a>(&self, object: &GraspedObject<'a>) -> Option<Held<'a>> {
        let body = upright_box(object.contacts)?;
        let middle = body.centre();
        let places = object.contacts.iter().map(|contact| contact.position);
        let mut flat: Vec<Point2<f64>> = places.map(|p| (p - middle.coords).xy()).collect();
        let outline = ConvexPolygon::convex_hull_of(&mut flat);
        let carrier = self.scene.carrier_of(object.contacts);
        let on_carrier = |index: usize| self.scene.surfaces[index].height_at(&middle.xy());
        Some(Held {
            object: *object,
            foot_m: carrier.map_or(middle.z - body.half_sides_m.z, on_carrier),
            load: CarriedLoad::of(
                object.contacts,
                &object.grasp.plan_from_tool,
                Some(object.index),
            )?,
            outline: outline.corners().to_vec(),
            body,
        })
    }

    /// Pose of a candidate, if it is free.
    fn checked(
        &self,
        held: &Held<'_>,
        area: &PlaceArea,
        candidate: &PlaceCandidate,
    ) -> Result<FreePose, PlaceRejection> {
        let turn = nalgebra::Rotation2::new(candidate.turn_rad);
        let corners = held
            .outline
            .iter()
            .map(|c| candidate.place + turn * c.coords);
        let corners: Vec<Point2<f64>> = corners.collect();
        if corners.iter().any(|c| !area.outline.contains(c)) {
            return Err(PlaceRejection::OverOutline);
        }
        let surface = area.surface_at(self.scene, &candidate.place);
        let index = surface.ok_or(PlaceRejection::NoSurface)?;
        let surface = &self.scene.surfaces[index];
        let over_rim = |c: &Point2<f64>| surface.outline.signed_distance_m(c) < RIM_M;
        if corners.iter().any(over_rim) {
            return Err(PlaceRejection::NoSurface);
        }
        let height_m = surface.height_at(&candidate.place);
        let up_m = height_m + RELEASE_M - held.foot_m;
        let moved = candidate.motion(&held.body.centre(), up_m);
        let body = held.body.transformed(&moved);
        let collision = self.collision(held, None, self.placed.joints_rad);
        let swept = swept_up(&grown_sides(&body));
        if let Some(by) = self.obstacles.hit_by(&swept, |o| collision.is_ignored(o)) {
            return Err(PlaceRejection::Occupied { by });
        }
        self.check_seen(&body, height_m)?;
        let is_in_image = |corner: &Point3<f64>| self.scene.space.is_in_image(corner);
        if !body.corners().iter().all(is_in_image) {
            return Err(PlaceRejection::CutByImage);
        }
        let plan_from_tool = moved * held.object.grasp.plan_from_tool;
        let up = Translation3::new(0.0, 0.0, WAY_M);
        for pose in [plan_from_tool, up * plan_from_tool] {
            // Cheap: the closed form alone.
            if !self
                .placed
                .arm
                .can_reach(&self.placed.plan_from_base.inv_mul(&pose))
            {
                return Err(PlaceRejection::OutOfReach);
            }
        }
        self.check_hand(held, &plan_from_tool)?;
        Ok(FreePose {
            plan_from_tool,
            foot: Point3::new(candidate.place.x, candidate.place.y, height_m),
            turn_rad: candidate.turn_rad,
            surface: index,
        })
    }

    /// Most of the surface below a body must be seen, or what is in front of it.
    fn check_seen(&self, body: &OrientedBox, height_m: f64) -> Result<(), PlaceRejection> {
        let half = body.half_sides_m;
        let steps = half.map(|half| (half / SEEN_STEP_M).ceil().max(1.0) as i32);
        let (mut n, mut n_unseen) = (0, 0);
        for i in -steps.x..=steps.x {
            for j in -steps.y..=steps.y {
                let share = |k: i32, n: i32| f64::from(k) / f64::from(n);
                let at = Point3::new(half.x * share(i, steps.x), half.y * share(j, steps.y), 0.0);
                let mut place = body.frame_from_box * at;
                place.z = height_m;
                let state = self.scene.space.state(&place);
                n += 1;
                n_unseen += i32::from(matches!(
                    state,
                    SpaceState::Hidden(_) | SpaceState::Unmeasured
                ));
            }
        }
        if f64::from(n_unseen) > UNSEEN_MAX * f64::from(n) {
            return Err(PlaceRejection::Unseen);
        }
        Ok(())
    }

    /// The hand must be free on the way down, when it opens, and on its way back.
    fn check_hand(
        &self,
        held: &Held<'_>,
        plan_from_tool: &RigidTransform,
    ) -> Result<(), PlaceRejection> {
        let gripper = self.placed.arm.gripper();
        let grasp = held.object.grasp;
        let back = hand_boxes(gripper, grasp.opening_m)
            .map(|body| swept_back(&body, WAY_M).transformed(plan_from_tool));
        let down = [0.5, 1.0].into_iter().flat_map(|share| {
            let up = Translation3::new(0.0, 0.0, share * WAY_M) * plan_from_tool;
            hand_boxes(gripper, grasp.width_m).map(|body| body.transformed(&up))
        });
        let collision = self.collision(held, None, self.placed.joints_rad);
        let mut bodies = back.into_iter().chain(down);
        match bodies.find_map(|body| collision.hit_by_box(&body)) {
            Some(what) => Err(PlaceRejection::HandHits { what }),
            None => Ok(()),
        }
    }

    /// Collision test of the arm at the place, with or without the object.
    fn collision<'a>(
        &'a self,
        held: &'a Held<'_>,
        load: Option<&'a CarriedLoad>,
        at_rad: JointVector,
    ) -> ArmCollision<'a> {
        let grasp = held.object.grasp;
        ArmCollision {
            scene: self.scene,
            obstacles: self.obstacles,
            placed: self.placed,
            opening_m: load.map_or(grasp.opening_m, |_| grasp.width_m),
            load,
            released: Some(held.object.index),
            ends: [at_rad, at_rad],
        }
    }

    /// Joint angles with which the arm moves straight down to the place and straight back.
    fn reached(&self, held: &Held<'_>, free: &FreePose) -> Result<PlacePose, PlaceRejection> {
        let plan_from_tool = free.plan_from_tool;
        let in_base = |pose: &RigidTransform| self.placed.plan_from_base.inv_mul(pose);
        let up = Translation3::from(Vector3::z() * WAY_M);
        let above = in_base(&(up * plan_from_tool));
        let release = in_base(&plan_from_tool);
        let back = in_base(&(plan_from_tool * Translation3::new(0.0, 0.0, -WAY_M)));
        let arm = &self.placed.arm;
        let grasp = held.object.grasp;
        let near = grasp
            .joints
            .map_or(self.placed.joints_rad, |joints| joints.lift_rad);
        let configurations = arm.configurations(&above, &near);
        let mut reason = PlaceRejection::OutOfReach;
        for above_rad in configurations.map_err(|_| PlaceRejection::OutOfReach)? {
            let lines = LineTrajectory::plan(arm, &above_rad, &release, SPEED).and_then(|down| {
                let back = LineTrajectory::plan(arm, &down.target_rad(), &back, SPEED)?;
                Ok([down, back])
            });
            let Ok(lines) = lines else {
                continue;
            };
            match self.hit_along(held, &lines) {
                Some(hit) => reason = PlaceRejection::ArmHits(hit),
                None => {
                    return Ok(PlacePose {
                        plan_from_tool,
                        foot: free.foot,
                        turn_rad: free.turn_rad,
                        way_m: WAY_M,
                        opening_m: grasp.opening_m,
                        surface: self.scene.surfaces[free.surface].name.clone(),
                        above_rad,
                        release_rad: lines[0].target_rad(),
                        retreat_rad: lines[1].target_rad(),
                    });
                }
            }
        }
        Err(reason)
    }

    /// First thing that the arm hits on its way down with the object, and back without it.
    fn hit_along(
        &self,
        held: &Held<'_>,
        [down, back]: &[LineTrajectory; 2],
    ) -> Option<crate::ArmObstacle> {
        let along = |line: &LineTrajectory, collision: &ArmCollision<'_>| {
            (0..=N_LINE_STEPS).find_map(|k| {
                let time_s = line.duration_s() * k as f64 / N_LINE_STEPS as f64;
                collision.hit(&line.sample(time_s).angles_rad)
            })
        };
        let at_rad = down.target_rad();
        let with_load = self.collision(held, Some(&held.load), at_rad);
        let without = self.collision(held, None, at_rad);
        along(down, &with_load).or_else(|| along(back, &without))
    }
}

/// Box with sides that keep the clearance; its foot stays.
fn grown_sides(body: &OrientedBox) -> OrientedBox {
    let mut grown = grown_box(body, CLEARANCE_M);
    grown.half_sides_m.z = body.half_sides_m.z;
    grown
}

/// Upright box swept up along the way down.
fn swept_up(body: &OrientedBox) -> OrientedBox {
    let mut swept = *body;
    swept.half_sides_m.z += 0.5 * WAY_M;
    swept.frame_from_box.translation.z += 0.5 * WAY_M;
    swept
}
