//! Constraint set: a bit set of constraints.

use crate::constraint::Constraint;

/// Bit set of constraints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ConstraintSet(u8);

impl ConstraintSet {
    /// Empty set of constraints.
    pub const NONE: Self = Self(0);

    /// Bit mask on the wire: bit `i` is the constraint with discriminant `i`.
    pub fn bits(self) -> u8 {
        self.0
    }

    /// Set of constraints from a bit mask.
    pub fn from_bits(bits: u8) -> Self {
        Self(bits)
    }

    /// `true` when the set contains the constraint.
    pub fn contains(self, constraint: Constraint) -> bool {
        self.0 & constraint.bit() != 0
    }

    /// Constraints of the set in the order of their discriminants.
    pub fn iter(self) -> impl Iterator<Item = Constraint> {
        Constraint::ALL
            .into_iter()
            .filter(move |one| self.contains(*one))
    }

    /// `true` when the set is empty.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl From<Constraint> for ConstraintSet {
    fn from(constraint: Constraint) -> Self {
        Self(constraint.bit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_contains_its_constraints() {
        let set = ConstraintSet::from(Constraint::Edge).union(Constraint::Table.into());
        let held: Vec<_> = set.iter().collect();
        assert_eq!(held, [Constraint::Table, Constraint::Edge]);
        assert_eq!(ConstraintSet::from_bits(set.bits()), set);
        assert!(ConstraintSet::default().is_empty() && !set.is_empty());
    }
}
