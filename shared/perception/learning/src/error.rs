//! Errors of descriptor comparison.

use crate::Metric;

/// Rejected descriptor.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Length different from that of the other descriptors.
    #[error(
        "a descriptor of {found} values cannot be compared with descriptors of \
         {expected}: describe both in the same way"
    )]
    Dimension {
        /// Length of the other descriptors.
        expected: usize,
        /// Length of this descriptor.
        found: usize,
    },
    /// Value outside the domain of the metric.
    #[error(
        "value {position} of the descriptor is {value}, but the metric {metric} takes \
         finite values from {} to {}: describe the view again",
        metric.values().start(),
        metric.values().end()
    )]
    Value {
        /// Index of the value.
        position: usize,
        /// Rejected value.
        value: f32,
        /// Metric of the comparison.
        metric: Metric,
    },
}
