//! RRT-Connect in joint space (Kuffner and LaValle 2000): two trees that grow towards each other.

use crate::arm_collision::{LEVERS_M, motion_m};
use arm_kinematics::{JointVector, KinematicChain, N_JOINTS};
use random::Random;
use std::f64::consts::PI;

/// Length of a branch, metres of motion of the arm.
const BRANCH_M: f64 = 0.20;
/// Angle beyond both ends within which configurations are drawn, radians: the wrist seldom needs to
/// turn away.
const BEYOND_RAD: [f64; N_JOINTS] = [PI, PI, PI, 1.4, 1.4, 1.4];

/// Tree of configurations.
struct Tree {
    nodes: Vec<(JointVector, usize)>,
}

/// Result of growing a tree towards a configuration.
enum TreeGrowth {
    /// Something is in the way at once.
    Blocked,
    /// A branch was added, its node has this index.
    Advanced(usize),
    /// The configuration was reached by the node of this index.
    Reached(usize),
}

impl Tree {
    fn of(root: JointVector) -> Self {
        Self {
            nodes: vec![(root, 0)],
        }
    }

    fn nearest(&self, to: &JointVector) -> usize {
        let distance = |(node, _): &(JointVector, usize)| {
            let joints = (0..N_JOINTS).map(|i| ((to[i] - node[i]) * LEVERS_M[i]).powi(2));
            joints.sum::<f64>()
        };
        let numbered = self.nodes.iter().map(distance).enumerate();
        let nearest = numbered.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map_or(0, |(index, _)| index)
    }

    /// Grows one branch from the nearest node.
    fn extend(
        &mut self,
        to: &JointVector,
        is_free: &mut impl FnMut(&JointVector, &JointVector) -> bool,
    ) -> TreeGrowth {
        let parent = self.nearest(to);
        let from = self.nodes[parent].0;
        let share = BRANCH_M / motion_m(&from, to).max(1e-12);
        let target = if share >= 1.0 {
            *to
        } else {
            from + (to - from) * share
        };
        if !is_free(&from, &target) {
            return TreeGrowth::Blocked;
        }
        self.nodes.push((target, parent));
        let index = self.nodes.len() - 1;
        if share >= 1.0 {
            TreeGrowth::Reached(index)
        } else {
            TreeGrowth::Advanced(index)
        }
    }

    /// Grows branches until the configuration is reached or something is in the way.
    fn connect(
        &mut self,
        to: &JointVector,
        is_free: &mut impl FnMut(&JointVector, &JointVector) -> bool,
    ) -> TreeGrowth {
        loop {
            let growth = self.extend(to, is_free);
            if !matches!(growth, TreeGrowth::Advanced(_)) {
                return growth;
            }
        }
    }

    /// Configurations from a node to the root.
    fn to_root(&self, mut index: usize) -> Vec<JointVector> {
        let mut path = vec![self.nodes[index].0];
        while index != 0 {
            index = self.nodes[index].1;
            path.push(self.nodes[index].0);
        }
        path
    }
}

/// Configurations from start to goal whose straight connections in joint space are free, and the
/// number of nodes of both trees; no path after `n_draws` draws.
pub(crate) fn rrt_connect(
    chain: &KinematicChain,
    [start, goal]: &[JointVector; 2],
    (n_draws, random): (usize, &mut Random),
    mut is_free: impl FnMut(&JointVector, &JointVector) -> bool,
) -> (Option<Vec<JointVector>>, usize) {
    let mut trees = [Tree::of(*start), Tree::of(*goal)];
    let mut is_swapped = false;
    let mut target = *goal;
    for _ in 0..n_draws {
        let [grown, other] = &mut trees;
        if let TreeGrowth::Advanced(tip) | TreeGrowth::Reached(tip) =
            grown.extend(&target, &mut is_free)
        {
            let reached = grown.nodes[tip].0;
            if let TreeGrowth::Reached(met) = other.connect(&reached, &mut is_free) {
                let mut path = grown.to_root(tip);
                path.reverse();
                path.extend(other.to_root(met).into_iter().skip(1));
                if is_swapped {
                    path.reverse();
                }
                return (Some(path), n_nodes(&trees));
            }
        }
        trees.swap(0, 1);
        is_swapped = !is_swapped;
        target = drawn(chain, start, goal, random);
    }
    (None, n_nodes(&trees))
}

fn n_nodes(trees: &[Tree; 2]) -> usize {
    trees.iter().map(|tree| tree.nodes.len()).sum()
}

/// Random configuration around both ends, within the joints' limits.
fn drawn(
    chain: &KinematicChain,
    start: &JointVector,
    goal: &JointVector,
    random: &mut Random,
) -> JointVector {
    JointVector::from_fn(|i, _| {
        let joint = &chain.joints[i];
        let low = (start[i].min(goal[i]) - BEYOND_RAD[i]).max(joint.min_rad);
        let high = (start[i].max(goal[i]) + BEYOND_RAD[i]).min(joint.max_rad);
        random.between(low, high)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use arm_kinematics::{Arm, HOME};

    /// Wall in the plane of the first two joints, with one gap.
    fn is_inside_wall(joints: &JointVector) -> bool {
        (joints[0] - 0.5).abs() < 0.1 && !(0.9..1.3).contains(&joints[1])
    }

    fn is_free(from: &JointVector, to: &JointVector) -> bool {
        (0..=50).all(|k| !is_inside_wall(&(from + (to - from) * (f64::from(k) / 50.0))))
    }

    fn ends() -> [JointVector; 2] {
        let start = JointVector::from(HOME);
        let mut goal = start;
        goal[0] = 1.0;
        [start, goal]
    }

    #[test]
    fn path_leads_through_the_gap_of_a_wall_and_repeats_with_its_seed() {
        let arm = Arm::jaco_like();
        for seed in 0..20 {
            let plan = || {
                let mut random = Random::from_seed(seed);
                rrt_connect(arm.chain(), &ends(), (3000, &mut random), is_free)
            };
            let (path, n_nodes) = plan();
            let path = path.expect("there is a gap");
            assert_eq!((path[0], path[path.len() - 1]), (ends()[0], ends()[1]));
            assert!(path.windows(2).all(|pair| is_free(&pair[0], &pair[1])));
            assert!(path.iter().all(|joints| arm.chain().check(joints).is_ok()));
            assert_eq!(plan(), (Some(path), n_nodes));
        }
    }

    #[test]
    fn closed_wall_has_no_path() {
        let arm = Arm::jaco_like();
        let mut random = Random::from_seed(1);
        let closed = |from: &JointVector, to: &JointVector| {
            (0..=50).all(|k| {
                let joints = from + (to - from) * (f64::from(k) / 50.0);
                (joints[0] - 0.5).abs() > 0.1
            })
        };
        let (path, n_nodes) = rrt_connect(arm.chain(), &ends(), (300, &mut random), closed);
        assert!(path.is_none() && n_nodes > 20, "{n_nodes}");
    }
}
