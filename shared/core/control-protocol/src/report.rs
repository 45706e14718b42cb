//! Reports of perception and learning that are replies of the control protocol.

use serde::{Deserialize, Serialize};

/// Report of the depth noise that perception measures on the table.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct DepthNoiseReport {
    /// Name of the configured law: `kinect-v1`, `stereo` or `time-of-flight`.
    pub law: String,
    /// Ratio of the measured noise and warp to the law, 1 to 4, median of up to 10 s; null
    /// before a table was seen for a second.
    pub ratio: Option<f64>,
    /// Depth of the middle of the table along the optical axis, metres; null before a table was
    /// seen.
    pub table_depth_m: Option<f64>,
}

/// Confirmation of a durable change of learned views.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LearningReport {
    /// History sequence number of the change.
    pub sequence: u64,
    /// Name of the affected category.
    pub category: String,
    /// Number of views that changed their category.
    pub n_views_changed: u64,
}
