//! Document of a learned category.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Learned category.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CategoryDocument {
    /// Name of the learned category.
    pub category: String,
    /// Number of stored views of the category.
    pub n_views: u64,
    /// Size of the descriptors and point clouds of its views, bytes.
    pub bytes: u64,
    /// Time of the last teaching, nanoseconds since 1970.
    pub last_taught_ns: i64,
}
