//! Errors of the pipeline crate.

/// Error of an invalid setting, measurement or object.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Probability threshold for unknown objects out of range.
    #[error("the probability below which objects are unknown must lie between 0 and 1, not {0}")]
    KnownProbability(f32),
    /// Detection error: the cloud cannot be searched.
    #[error("{0}")]
    Detection(#[source] detection::Error),
    /// Rejected setting or measurement of the tracking crate.
    #[error("{0}")]
    Tracking(#[source] tracking::Error),
    /// Description error for an object's points.
    #[error("{0}")]
    Description(#[source] description::Error),
    /// Descriptor that does not fit the stored ones.
    #[error("{0}")]
    Learning(#[source] learning::Error),
}
