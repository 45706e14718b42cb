//! Why descriptors can not be compared.

use crate::Metric;
use std::fmt;

/// Why a descriptor was refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// It has another length than those it should be compared with.
    Dimension {
        /// Values of the other descriptors.
        expected: usize,
        /// Values of this one.
        found: usize,
    },
    /// One of its values is none that the metric takes.
    Value {
        /// Which one, from 0.
        position: usize,
        /// The value.
        value: f32,
        /// The metric.
        metric: Metric,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Dimension { expected, found } => write!(
                f,
                "a descriptor of {found} values can not be compared with descriptors of \
                 {expected}: describe both in the same way"
            ),
            Self::Value {
                position,
                value,
                metric,
            } => write!(
                f,
                "value {position} of the descriptor is {value}, but the metric {metric} takes \
                 finite values from {} to {}: describe the view again",
                metric.values().start(),
                metric.values().end()
            ),
        }
    }
}

impl std::error::Error for Error {}
