//! Errors of descriptor comparison.

use crate::Metric;

/// Error of a descriptor that cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Descriptor length different from that of the other descriptors.
    #[error(
        "a descriptor of {found} values cannot be compared with descriptors of \
         {expected}: describe both in the same way"
    )]
    Dimension {
        /// Length of the other descriptors, values.
        expected: usize,
        /// Length of the rejected descriptor, values.
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
        /// Index of the invalid descriptor value.
        position: usize,
        /// Invalid descriptor value.
        value: f32,
        /// Distance metric of the comparison.
        metric: Metric,
    },
}
