//! Ternary truth value: false, unknown or true.

coded_enum::coded_enum! {
    /// Ternary truth value of Kleene's strong logic (Kleene 1952, § 64), ordered from false to
    /// true.
    #[derive(PartialOrd, Ord)]
    pub enum Ternary: u16 {
        /// The predicate does not hold.
        False, "false";
        /// The predicate is undecided.
        Unknown, "unknown";
        /// The predicate holds.
        True, "true";
    }
}

impl Ternary {
    /// Conjunction: the lesser of the two values.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        self.min(other)
    }

    /// Disjunction: the greater of the two values.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        self.max(other)
    }

    /// Negation; the negation of unknown is unknown.
    #[must_use]
    #[expect(
        clippy::should_implement_trait,
        reason = "the name matches `and` and `or`"
    )]
    pub fn not(self) -> Self {
        match self {
            Self::False => Self::True,
            Self::Unknown => Self::Unknown,
            Self::True => Self::False,
        }
    }
}

impl From<bool> for Ternary {
    fn from(holds: bool) -> Self {
        if holds { Self::True } else { Self::False }
    }
}

#[cfg(test)]
mod tests {
    use super::Ternary::{False, True, Unknown};
    use super::*;

    #[test]
    fn operators_match_kleenes_truth_tables() {
        let conjunction = [
            [False, False, False],
            [False, Unknown, Unknown],
            [False, Unknown, True],
        ];
        let disjunction = [
            [False, Unknown, True],
            [Unknown, Unknown, True],
            [True, True, True],
        ];
        for (i, a) in Ternary::ALL.into_iter().enumerate() {
            for (j, b) in Ternary::ALL.into_iter().enumerate() {
                assert_eq!(a.and(b), conjunction[i][j], "{a:?} and {b:?}");
                assert_eq!(a.or(b), disjunction[i][j], "{a:?} or {b:?}");
            }
        }
        assert_eq!(Ternary::ALL.map(Ternary::not), [True, Unknown, False]);
    }

    #[test]
    fn value_round_trips_through_its_code() {
        for truth in Ternary::ALL {
            assert_eq!(Ternary::from_code(truth.code()), Some(truth));
        }
        assert_eq!(Ternary::from_code(3), None);
        assert_eq!([Ternary::from(false), Ternary::from(true)], [False, True]);
    }
}
