//! What can go wrong with an input.

use std::fmt;

/// Why a cloud could not be searched.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Error {
    /// The cloud has more points than an index can name.
    TooLarge {
        /// Number of its points.
        n_points: usize,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLarge { n_points } => write!(
                f,
                "a cloud of {n_points} points is larger than an image of 8192x8192; reduce it first"
            ),
        }
    }
}

impl std::error::Error for Error {}
