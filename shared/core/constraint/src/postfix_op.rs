//! Postfix operation: the element of a parsed rule.

use crate::Constraint;

/// Greatest number of constraint names in a rule; it bounds the evaluation stack.
pub(crate) const N_NAMES_MAX: usize = 32;

/// Postfix operation of a rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PostfixOp {
    /// Push the value of a constraint.
    Is(Constraint),
    /// Negate the topmost value of the stack.
    Not,
    /// Conjunction of the two topmost stack values.
    And,
    /// Disjunction of the two topmost stack values.
    Or,
}
