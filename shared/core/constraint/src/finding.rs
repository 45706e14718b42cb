//! Finding: the ternary value of one constraint with its reason.

use crate::reason::Reason;
use crate::ternary::Ternary;

/// Finding: the ternary value of one constraint for one candidate, with its reason.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// Ternary value of the constraint.
    pub value: Ternary,
    /// Reason for the value of the finding.
    pub reason: Reason,
}
