//! Who begins again when one fails.

use std::ops::Range;

/// Which children begin again when one of them does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// Only the one that failed: the others do not depend on it.
    OneForOne,
    /// All of them: each depends on each.
    OneForAll,
    /// The one that failed and those after it: each depends on those before.
    RestForOne,
}

impl Strategy {
    /// The places of those who begin again, of `n` children in their order.
    pub(crate) fn affected(self, failed: usize, n: usize) -> Range<usize> {
        match self {
            Self::OneForOne => failed..failed + 1,
            Self::OneForAll => 0..n,
            Self::RestForOne => failed..n,
        }
    }
}
