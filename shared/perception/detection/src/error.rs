//! Errors of detection.

use thiserror::Error;

/// Error of detection.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Error {
    /// Cloud with more points than an index can address.
    #[error("a cloud of {n_points} points is larger than an image of 8192x8192; reduce it first")]
    TooLarge {
        /// Number of points in the cloud.
        n_points: usize,
    },
}
