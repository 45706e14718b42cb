//! Errors of the tracking crate.

use value_range::OutOfRange;

/// Error of a rejected measurement or setting.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Measurement outside the physically possible range of an object.
    #[error("the measurement cannot be that of an object: {rule}; ignore it")]
    ImpossibleMeasurement {
        /// Constraint that the measurement violates, as a clause.
        rule: &'static str,
    },
    /// Measurement older than the state of the track.
    #[error(
        "the measurement of {stamp_ns} ns is older than the track's state of \
         {state_stamp_ns} ns; give each track its frames in the order of capture"
    )]
    OutOfOrder {
        /// Capture stamp of the rejected measurement.
        stamp_ns: u64,
        /// Capture stamp of the track's state.
        state_stamp_ns: u64,
    },
    /// Tracking setting outside its valid range.
    #[error("the tracking setting {0}")]
    InvalidSetting(#[from] OutOfRange),
}
