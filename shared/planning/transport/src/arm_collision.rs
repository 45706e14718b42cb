//! Collision test of the whole arm: its links, its hand and what it holds, against obstacles,
//! support surfaces and itself.

use crate::carried_load::CarriedLoad;
use arm_kinematics::{JointVector, N_JOINTS, link_capsules, self_clearance_m};
use geometry::{Capsule, OrientedBox};
use grasping::{
    GraspScene, N_BASE_CAPSULES, N_HAND_CAPSULES, Obstacle, Obstacles, PlacedArm,
    box_meets_capsule, hand_boxes,
};
use nalgebra::Vector3;

/// Distance from the axis of each joint to the farthest place that it moves, metres, of the
/// JACO-like arm with something in its hand.
pub(crate) const LEVERS_M: [f64; N_JOINTS] = [0.9, 0.9, 0.7, 0.35, 0.3, 0.15];
/// Distance that any part of the arm moves between two tested configurations, metres: less than
/// two voxels.
const STEP_M: f64 = 0.015;
/// Distance that the arm keeps from things on its way, metres. Chosen: the error of a Kinect at
/// 1.2 m, and that of the arm's path between two tested configurations.
const CLEARANCE_M: f64 = 0.015;
/// Share of the way from the nearer end that the arm keeps from things: the ends are given, and may
/// be nearer to something than the way.
const CLEARANCE_SHARE: f64 = 0.15;

/// Thing that the arm would hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmObstacle {
    /// The arm: links that are not neighbours, or the load.
    Itself,
    /// Something else.
    Thing(Obstacle),
}

impl ArmObstacle {
    /// Name of the thing for people.
    pub fn name(self, scene: &GraspScene<'_>) -> String {
        match self {
            Self::Itself => "itself".to_owned(),
            Self::Thing(obstacle) => obstacle.name(scene),
        }
    }
}

/// Collision test of an arm between two configurations.
pub(crate) struct ArmCollision<'a> {
    pub(crate) scene: &'a GraspScene<'a>,
    pub(crate) obstacles: &'a Obstacles,
    pub(crate) placed: &'a PlacedArm,
    /// Distance between the pads, metres.
    pub(crate) opening_m: f64,
    /// Object in the hand.
    pub(crate) load: Option<&'a CarriedLoad>,
    /// Object that is no obstacle though nobody holds it: one that was just set down.
    pub(crate) released: Option<usize>,
    /// Configurations between which the arm moves, radians.
    pub(crate) ends: [JointVector; 2],
}

/// Box whose faces are moved outwards, metres.
pub(crate) fn grown_box(body: &OrientedBox, by_m: f64) -> OrientedBox {
    OrientedBox {
        half_sides_m: body.half_sides_m + Vector3::repeat(by_m),
        ..*body
    }
}

/// Greatest distance that a part of the arm moves between two configurations, metres; a bound.
pub(crate) fn motion_m(from: &JointVector, to: &JointVector) -> f64 {
    let joints = (0..N_JOINTS).map(|i| (to[i] - from[i]).abs() * LEVERS_M[i]);
    joints.sum()
}

impl ArmCollision<'_> {
    /// First thing that is hit on the straight way in joint space, the ends included.
    pub(crate) fn first_hit(&self, from: &JointVector, to: &JointVector) -> Option<ArmObstacle> {
        let n = (motion_m(from, to) / STEP_M).ceil().max(1.0) as usize;
        let at = |k: usize| from + (to - from) * (k as f64 / n as f64);
        let ends = self.hit(from).or_else(|| self.hit(to));
        ends.or_else(|| halving_order(n).find_map(|k| self.hit(&at(k))))
    }

    /// First thing that the arm hits in a configuration.
    pub(crate) fn hit(&self, joints_rad: &JointVector) -> Option<ArmObstacle> {
        let near_end_m = self.ends.iter().map(|end| motion_m(end, joints_rad));
        let near_end_m = near_end_m.fold(f64::INFINITY, f64::min);
        let clearance_m = CLEARANCE_M.min(CLEARANCE_SHARE * near_end_m);
        let arm = &self.placed.arm;
        let capsules = link_capsules(arm, joints_rad, self.opening_m);
        if self_clearance_m(&capsules) < 0.0 {
            return Some(ArmObstacle::Itself);
        }
        let plan_from_base = &self.placed.plan_from_base;
        let links = capsules.map(|link| link.transformed(plan_from_base));
        let moved = &links[N_BASE_CAPSULES..links.len() - N_HAND_CAPSULES];
        let hit_link = moved
            .iter()
            .find_map(|link| self.hit_by_link(link, clearance_m));
        hit_link.map(ArmObstacle::Thing).or_else(|| {
            let plan_from_tool = plan_from_base * arm.tool_pose(joints_rad);
            let hand = hand_boxes(arm.gripper(), self.opening_m);
            let hand = hand.map(|body| body.transformed(&plan_from_tool));
            let mut bodies = hand.iter();
            let hit = bodies.find_map(|body| self.hit_by_box(&grown_box(body, clearance_m)));
            hit.map(ArmObstacle::Thing).or_else(|| {
                let load = self.load?.body_in_tool.transformed(&plan_from_tool);
                self.hit_by_load(&grown_box(&load, clearance_m), &links)
            })
        })
    }

    pub(crate) fn is_ignored(&self, obstacle: Obstacle) -> bool {
        match obstacle {
            Obstacle::Object(index) => {
                self.released == Some(index)
                    || self.load.is_some_and(|load| load.object == Some(index))
            }
            // Surfaces are planes, not the voxels that show them.
            Obstacle::Surface(_) => true,
            Obstacle::Person | Obstacle::Other => false,
        }
    }

    fn hit_by_link(&self, link: &Capsule, clearance_m: f64) -> Option<Obstacle> {
        let grown = Capsule {
            radius_m: link.radius_m + clearance_m,
            ..*link
        };
        let surfaces = self.scene.surfaces.iter();
        let surface = surfaces.enumerate().find(|(_, s)| s.is_hit_by_link(&grown));
        surface
            .map(|(index, _)| Obstacle::Surface(index))
            .or_else(|| self.obstacles.hit_by_link(&grown, |o| self.is_ignored(o)))
    }

    pub(crate) fn hit_by_box(&self, body: &OrientedBox) -> Option<Obstacle> {
        let surfaces = self.scene.surfaces.iter();
        let surface = surfaces.enumerate().find(|(_, s)| s.is_hit_by_box(body));
        surface
            .map(|(index, _)| Obstacle::Surface(index))
            .or_else(|| self.obstacles.hit_by(body, |o| self.is_ignored(o)))
    }

    /// First thing that the load hits; it may touch the hand, and not the links before the wrist.
    fn hit_by_load(&self, load: &OrientedBox, links: &[Capsule]) -> Option<ArmObstacle> {
        let upper = &links[..N_UPPER_CAPSULES];
        if upper.iter().any(|link| box_meets_capsule(load, link)) {
            return Some(ArmObstacle::Itself);
        }
        self.hit_by_box(load).map(ArmObstacle::Thing)
    }
}

/// Number of capsules at the beginning that are no wrist and no hand: base to forearm.
const N_UPPER_CAPSULES: usize = 6;

/// Numbers 1 to `n - 1`, each once, the middles of the widest gaps first: a hit is found early.
fn halving_order(n: usize) -> impl Iterator<Item = usize> {
    let first = n.next_power_of_two();
    let strides = std::iter::successors(Some(first), |stride| (*stride > 1).then_some(stride / 2));
    strides.flat_map(move |stride| {
        let half = stride / 2;
        let begin = if half > 0 { half } else { n };
        (begin..n).step_by(stride.max(1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn halving_order_has_each_number_once_and_begins_in_the_middle() {
        for n in 1..40 {
            let order: Vec<usize> = halving_order(n).collect();
            let set: BTreeSet<usize> = order.iter().copied().collect();
            assert_eq!(order.len(), n - 1, "{n}: {order:?}");
            assert_eq!(set, (1..n).collect(), "{n}");
        }
        assert_eq!(halving_order(8).next(), Some(4));
    }
}
