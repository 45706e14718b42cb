//! What can go wrong in a step.

use std::fmt;

/// Why a setting, a measurement or an object's points can not be used.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The probability below which objects are unknown.
    KnownProbability(f32),
    /// A setting or measurement of the tracking.
    Tracking(tracking::Error),
    /// The points can not be described.
    Description(description::Error),
    /// The descriptor does not fit the stored ones.
    Learning(learning::Error),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::KnownProbability(value) => write!(
                f,
                "the probability below which objects are unknown must lie between 0 and 1, not {value}"
            ),
            Self::Tracking(error) => error.fmt(f),
            Self::Description(error) => error.fmt(f),
            Self::Learning(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::KnownProbability(_) => None,
            Self::Tracking(error) => Some(error),
            Self::Description(error) => Some(error),
            Self::Learning(error) => Some(error),
        }
    }
}
