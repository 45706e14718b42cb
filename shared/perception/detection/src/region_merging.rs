//! Region merging: adjacent regions of an over-segmented cluster are merged while a
//! classifier of pairs finds them to be one object.

mod adjacency;
mod boundary;
mod continuation;
mod decision_tree;
mod pair_features;
mod region;
#[allow(
    clippy::approx_constant,
    reason = "trained numbers, near a constant by chance"
)]
mod trained_trees;

pub(crate) use adjacency::RegionAdjacency;
pub use adjacency::RegionPair;
pub use pair_features::{FEATURE_NAMES, N_FEATURES, PairFeatures};
