//! Transit: motion of the arm from one configuration to another past everything that is known.
//!
//! First over a safe height, where nothing stands; else by RRT-Connect in joint space.

use crate::arm_collision::{ArmCollision, ArmObstacle};
use crate::carried_load::CarriedLoad;
use crate::rrt_connect::rrt_connect;
use crate::safe_height::over_safe_height;
use crate::shortcut::shortened;
use arm_kinematics::{Arm, JointState, JointTrajectory, JointVector};
use grasping::{GraspScene, Obstacles, PlacedArm};
use random::Random;

/// Number of draws of RRT-Connect until there is no path.
const N_DRAWS: usize = 400;

/// Planner of transits in a scene.
#[derive(Clone, Copy)]
pub struct TransitPlanner<'a> {
    /// Scene.
    pub scene: &'a GraspScene<'a>,
    /// Obstacles within the arm's reach.
    pub obstacles: &'a Obstacles,
    /// Arm.
    pub placed: &'a PlacedArm,
    /// Distance between the pads on the way, metres.
    pub opening_m: f64,
    /// Object in the hand.
    pub load: Option<&'a CarriedLoad>,
    /// Seed of the random tree.
    pub seed: u64,
}

/// Kind of a transit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransitKind {
    /// Up, over what stands there, and down.
    OverSafeHeight,
    /// Found by RRT-Connect.
    RandomTree,
}

impl TransitKind {
    /// Word of the kind in documents.
    pub fn word(self) -> &'static str {
        match self {
            Self::OverSafeHeight => "over_safe_height",
            Self::RandomTree => "random_tree",
        }
    }
}

/// Path of the arm: straight motions in joint space from one configuration to the next.
#[derive(Debug, Clone, PartialEq)]
pub struct TransitPath {
    /// Configurations, radians: the first is the start, the last the goal.
    pub waypoints_rad: Vec<JointVector>,
    /// Kind of the path.
    pub kind: TransitKind,
    /// Number of nodes of the random tree; 0 without one.
    pub n_nodes: usize,
}

/// Reason why there is no transit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoTransit {
    /// The arm hits something where it stands.
    StartBlocked(ArmObstacle),
    /// The arm would hit something at the goal.
    GoalBlocked(ArmObstacle),
    /// No way was found.
    NoPath {
        /// Number of configurations that were reached.
        n_nodes: usize,
    },
}

impl TransitPlanner<'_> {
    /// Plans a path between two configurations, radians.
    ///
    /// # Errors
    /// The reason why there is none.
    pub fn plan(&self, start: &JointVector, goal: &JointVector) -> Result<TransitPath, NoTransit> {
        let collision = self.collision([*start, *goal]);
        if let Some(hit) = collision.hit(start) {
            return Err(NoTransit::StartBlocked(hit));
        }
        if let Some(hit) = collision.hit(goal) {
            return Err(NoTransit::GoalBlocked(hit));
        }
        if let Some(waypoints_rad) = over_safe_height(&collision) {
            return Ok(TransitPath {
                waypoints_rad,
                kind: TransitKind::OverSafeHeight,
                n_nodes: 0,
            });
        }
        let mut random = Random::from_seed(self.seed);
        let chain = self.placed.arm.chain();
        let is_free =
            |from: &JointVector, to: &JointVector| collision.first_hit(from, to).is_none();
        let (path, n_nodes) = rrt_connect(chain, &[*start, *goal], (N_DRAWS, &mut random), is_free);
        let path = path.ok_or(NoTransit::NoPath { n_nodes })?;
        Ok(TransitPath {
            waypoints_rad: shortened(path, &mut random, is_free),
            kind: TransitKind::RandomTree,
            n_nodes,
        })
    }

    pub(crate) fn collision(&self, ends: [JointVector; 2]) -> ArmCollision<'_> {
        ArmCollision {
            scene: self.scene,
            obstacles: self.obstacles,
            placed: self.placed,
            opening_m: self.opening_m,
            load: self.load,
            released: None,
            ends,
        }
    }
}

impl TransitPath {
    /// Time that an arm needs for the path, seconds; it rests at each configuration.
    pub fn duration_s(&self, arm: &Arm) -> f64 {
        let motions = self.waypoints_rad.windows(2).map(|pair| {
            let start = JointState::at_rest(pair[0]);
            JointTrajectory::new(arm.chain(), &start, &pair[1], 1.0).duration_s()
        });
        motions.sum()
    }
}

impl NoTransit {
    /// Reason in words, with the names of the things of a scene.
    pub fn words(&self, scene: &GraspScene<'_>) -> String {
        match self {
            Self::StartBlocked(hit) => format!("the arm begins too near to {}", hit.name(scene)),
            Self::GoalBlocked(hit) => format!("at its end the arm would hit {}", hit.name(scene)),
            Self::NoPath { n_nodes } => {
                format!("no way past the obstacles was found, by {n_nodes} configurations")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{PinholeCamera, RigidTransform};
    use grasping::{ObservedSpace, Obstacle};

    #[test]
    fn reasons_are_sentences_with_names() {
        let space = ObservedSpace::new(PinholeCamera::KINECT_V1, RigidTransform::identity(), &[]);
        let scene = GraspScene::new(space, Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let person = ArmObstacle::Thing(Obstacle::Person);
        for (reason, words) in [
            (
                NoTransit::StartBlocked(person),
                "begins too near to a person",
            ),
            (NoTransit::GoalBlocked(ArmObstacle::Itself), "hit itself"),
            (NoTransit::NoPath { n_nodes: 31 }, "no way"),
        ] {
            assert!(reason.words(&scene).contains(words), "{reason:?}");
        }
    }
}
