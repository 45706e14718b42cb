//! Gradient-boosted decision trees (Friedman 2001): evaluation.

use super::pair_features::PairFeatures;
use super::trained_trees::{CONSTANT, TREES};

/// Depth of a tree: number of comparisons.
pub(super) const DEPTH: usize = 4;

/// Complete binary decision tree.
#[derive(Debug)]
pub(super) struct DecisionTree {
    /// Feature and threshold of each inner node, breadth first; a greater value goes right.
    pub(super) splits: [(u8, f32); (1 << DEPTH) - 1],
    /// Log odds of the leaves, from left to right.
    pub(super) leaves: [f32; 1 << DEPTH],
}

impl DecisionTree {
    /// Log odds that the tree adds for a pair.
    #[inline]
    fn log_odds(&self, features: &PairFeatures) -> f32 {
        let mut node = 0;
        for _ in 0..DEPTH {
            let (feature, threshold) = self.splits[node];
            node = 2 * node + 1 + usize::from(features[usize::from(feature)] > threshold);
        }
        self.leaves[node + 1 - (1 << DEPTH)]
    }
}

/// Log odds that a pair of regions is one object.
pub(super) fn log_odds(features: &PairFeatures) -> f32 {
    let of_trees = TREES.iter().map(|tree| tree.log_odds(features));
    CONSTANT + of_trees.sum::<f32>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region_merging::pair_features::N_FEATURES;

    #[test]
    fn a_greater_value_goes_right_at_every_level() {
        let tree = DecisionTree {
            splits: std::array::from_fn(|node| {
                let level = (node + 1).ilog2() as u8;
                (level, 0.5)
            }),
            leaves: std::array::from_fn(|leaf| leaf as f32),
        };
        for leaf in 0..1_usize << DEPTH {
            let mut features = [0.0; N_FEATURES];
            for (level, value) in features.iter_mut().enumerate().take(DEPTH) {
                *value = ((leaf >> (DEPTH - 1 - level)) & 1) as f32;
            }
            assert_eq!(tree.log_odds(&features), leaf as f32);
        }
    }

    #[test]
    fn trained_trees_compare_existing_features_with_finite_values() {
        for tree in &TREES {
            assert!(tree.leaves.iter().all(|leaf| leaf.is_finite()));
            for (feature, threshold) in tree.splits {
                assert!(usize::from(feature) < N_FEATURES && threshold.is_finite());
            }
        }
    }
}
