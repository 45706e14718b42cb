//! Safe height: the tool goes straight up, over everything that stands between the ends, and
//! straight down.

use crate::arm_collision::{ArmCollision, motion_m};
use arm_kinematics::{JointVector, LineTrajectory};
use geometry::{Plane, RigidTransform};
use grasping::{hand_boxes, lowest_m};
use nalgebra::{Point2, Point3, Translation3, Vector3};

/// Distance over what stands there, metres. Chosen.
const ABOVE_M: f64 = 0.04;
/// Distance from the straight way, seen from above, within which things count, metres: the half
/// width of hand and load.
const CORRIDOR_M: f64 = 0.15;
/// Share of the joints' speed at which the lines are planned; it changes no place on them.
const SPEED: f64 = 0.5;

/// Configurations of a path over a safe height; `None` where the arm cannot take it.
pub(crate) fn over_safe_height(collision: &ArmCollision<'_>) -> Option<Vec<JointVector>> {
    let [start, goal] = collision.ends;
    let placed = collision.placed;
    let tool_at = |joints: &JointVector| placed.plan_from_base * placed.arm.tool_pose(joints);
    let ends = [tool_at(&start), tool_at(&goal)];
    let top_m = top_between(collision, &ends);
    let hang_m = ends.map(|end| hang_m(collision, &end));
    let height_m = top_m + ABOVE_M + hang_m[0].max(hang_m[1]);
    let mut path = vec![start];
    for (joints, plan_from_tool) in [start, goal].iter().zip(&ends) {
        path.push(raised(collision, joints, plan_from_tool, height_m)?);
    }
    path.push(goal);
    path.dedup_by(|a, b| motion_m(a, b) < 1e-6);
    let is_free = |pair: &[JointVector]| collision.first_hit(&pair[0], &pair[1]).is_none();
    path.windows(2).all(is_free).then_some(path)
}

/// Configuration with the tool straight above its pose, at a height; the same one where it is higher
/// already.
fn raised(
    collision: &ArmCollision<'_>,
    joints: &JointVector,
    plan_from_tool: &RigidTransform,
    height_m: f64,
) -> Option<JointVector> {
    let up_m = height_m - plan_from_tool.translation.z;
    if up_m <= 0.0 {
        return Some(*joints);
    }
    let above = Translation3::from(Vector3::z() * up_m) * plan_from_tool;
    let base_from_tool = collision.placed.plan_from_base.inv_mul(&above);
    let line = LineTrajectory::plan(&collision.placed.arm, joints, &base_from_tool, SPEED).ok()?;
    Some(line.target_rad())
}

/// Height of the highest thing under the straight way between two poses, metres.
fn top_between(collision: &ArmCollision<'_>, ends: &[RigidTransform; 2]) -> f64 {
    let [from, to] = ends.map(|end| Point2::from(end.translation.vector.xy()));
    let along = to - from;
    let length2 = along.norm_squared().max(1e-12);
    let near = |place: &Point2<f64>| {
        let share = ((place - from).dot(&along) / length2).clamp(0.0, 1.0);
        (place - (from + along * share)).norm() < CORRIDOR_M
    };
    let things = collision.obstacles.voxels().iter();
    let under = things.filter(|(place, owner)| near(&place.xy()) && !collision.is_ignored(*owner));
    under
        .map(|(place, _)| place.z)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Distance by which hand and load hang below the tool at a pose, metres.
fn hang_m(collision: &ArmCollision<'_>, plan_from_tool: &RigidTransform) -> f64 {
    let hand = hand_boxes(collision.placed.arm.gripper(), collision.opening_m);
    let load = collision.load.map(|load| load.body_in_tool);
    let bodies = hand.into_iter().chain(load);
    let level = Plane::through(&Point3::origin(), Vector3::z_axis());
    let lowest = bodies.map(|body| lowest_m(&body.transformed(plan_from_tool), &level));
    plan_from_tool.translation.z - lowest.fold(f64::INFINITY, f64::min)
}
