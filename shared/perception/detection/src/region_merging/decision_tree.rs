//! Gradient-boosted oblivious decision trees (Friedman 2001): evaluation.

use super::pair_features::{N_FEATURES, PairFeatures};
use super::trained_trees::{CONSTANT, TREES};

/// Depth of a tree: number of comparisons.
pub(super) const DEPTH: usize = 6;

/// Number of leaves of a tree.
const N_LEAVES: usize = 1 << DEPTH;

/// Number of pairs that are evaluated together.
pub(super) const LANES: usize = 8;

/// Oblivious decision tree: all nodes of a level compare the same feature with the same
/// threshold.
#[derive(Debug)]
pub(super) struct DecisionTree {
    /// Feature and threshold of each level, from the root on; a greater value goes right.
    pub(super) splits: [(u8, f32); DEPTH],
    /// Log odds of the leaves, from left to right.
    pub(super) leaves: [f32; N_LEAVES],
}

/// Features of up to [`LANES`] pairs, feature by feature.
#[derive(Debug, Clone, Copy)]
pub(super) struct FeatureLanes([[f32; LANES]; N_FEATURES]);

impl Default for FeatureLanes {
    fn default() -> Self {
        Self([[0.0; LANES]; N_FEATURES])
    }
}

impl FeatureLanes {
    /// Set the features of one pair.
    pub(super) fn set(&mut self, lane: usize, features: &PairFeatures) {
        for (lanes, feature) in self.0.iter_mut().zip(features) {
            lanes[lane] = *feature;
        }
    }

    /// Log odds that each pair is one object.
    pub(super) fn log_odds(&self) -> [f32; LANES] {
        let mut sums = [CONSTANT; LANES];
        for tree in &TREES {
            tree.add_log_odds(&self.0, &mut sums);
        }
        sums
    }
}

impl DecisionTree {
    /// Add the log odds of the tree for each lane.
    #[inline]
    fn add_log_odds(&self, features: &[[f32; LANES]; N_FEATURES], sums: &mut [f32; LANES]) {
        let mut leaves = [0_u32; LANES];
        for (feature, threshold) in self.splits {
            let values = &features[usize::from(feature)];
            for (leaf, value) in leaves.iter_mut().zip(values) {
                // The sign bit of the difference: a comparison would leave the vector lanes.
                *leaf = 2 * *leaf + ((threshold - value).to_bits() >> 31);
            }
        }
        for (sum, leaf) in sums.iter_mut().zip(leaves) {
            *sum += self.leaves[leaf as usize % N_LEAVES];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_is_found_by_the_comparisons_of_all_levels() {
        let tree = DecisionTree {
            splits: std::array::from_fn(|level| (level as u8, 0.5)),
            leaves: std::array::from_fn(|leaf| leaf as f32),
        };
        for leaf in 0..N_LEAVES {
            let mut features = [[0.0; LANES]; N_FEATURES];
            for (level, values) in features.iter_mut().enumerate().take(DEPTH) {
                values[3] = ((leaf >> (DEPTH - 1 - level)) & 1) as f32;
            }
            let mut sums = [1.0; LANES];
            tree.add_log_odds(&features, &mut sums);
            assert_eq!((sums[3], sums[0]), (1.0 + leaf as f32, 1.0));
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
