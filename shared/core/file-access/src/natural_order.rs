//! Natural sort order of file names.

use std::cmp::Ordering;

/// Compares names in natural sort order: `learn2` comes before `learn10`.
///
/// Runs of ASCII digits compare by their value, everything else by its bytes.
/// Names that differ only in leading zeros compare by their bytes at last, so
/// this is a total order, equal for identical names only.
///
/// *Complexity*: linear in the shorter name, no allocation; a run of digits
/// may have any length.
pub fn natural_order(left: &str, right: &str) -> Ordering {
    Tokens(left.as_bytes())
        .cmp(Tokens(right.as_bytes()))
        .then_with(|| left.cmp(right))
}

/// Token of a name: one run of digits without leading zeros, or one other byte.
#[derive(PartialEq, Eq)]
enum Token<'a> {
    Number(&'a [u8]),
    Byte(u8),
}

impl Token<'_> {
    /// Rank among the bytes; that of a number is the rank of its digits, which keeps the order of
    /// numbers against bytes transitive.
    fn rank(&self) -> u8 {
        match self {
            Token::Number(_) => b'0',
            Token::Byte(byte) => *byte,
        }
    }
}

impl Ord for Token<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Token::Number(left), Token::Number(right)) => {
                left.len().cmp(&right.len()).then_with(|| left.cmp(right))
            }
            _ => self.rank().cmp(&other.rank()),
        }
    }
}

impl PartialOrd for Token<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

struct Tokens<'a>(&'a [u8]);

impl<'a> Iterator for Tokens<'a> {
    type Item = Token<'a>;

    fn next(&mut self) -> Option<Token<'a>> {
        let (&first, rest) = self.0.split_first()?;
        if !first.is_ascii_digit() {
            self.0 = rest;
            return Some(Token::Byte(first));
        }
        let is_other = |byte: &u8| !byte.is_ascii_digit();
        let (digits, rest) = self
            .0
            .split_at(self.0.iter().position(is_other).unwrap_or(self.0.len()));
        self.0 = rest;
        let n_zeros = digits.iter().take_while(|&&digit| digit == b'0').count();
        Some(Token::Number(&digits[n_zeros..]))
    }
}

#[cfg(test)]
mod tests {
    use super::natural_order;
    use proptest::prelude::*;
    use std::cmp::Ordering::{Equal, Greater, Less};

    #[test]
    fn numbers_compare_by_value() {
        for (left, right) in [
            ("learn2.pcd", "learn10.pcd"),
            ("learn9", "learn10"),
            ("a", "a0"),
            ("a007b", "a8"),
            ("a7b2", "a007b10"),
            ("007", "7"),
            ("", "0"),
            (
                "x99999999999999999999999999999998",
                "x99999999999999999999999999999999",
            ),
        ] {
            assert_eq!(natural_order(left, right), Less, "{left} {right}");
            assert_eq!(natural_order(right, left), Greater, "{right} {left}");
        }
    }

    /// Names of few different characters, so that digit runs are frequent.
    fn name() -> impl Strategy<Value = String> {
        prop::collection::vec(
            prop::sample::select(vec!['0', '1', '9', 'a', '/', ':', 'ä']),
            0..7,
        )
        .prop_map(|characters| characters.into_iter().collect())
    }

    proptest! {
        #[test]
        fn the_order_is_total(a in name(), b in name(), c in name()) {
            prop_assert_eq!(natural_order(&a, &b), natural_order(&b, &a).reverse());
            prop_assert_eq!(natural_order(&a, &b) == Equal, a == b);
            if natural_order(&a, &b) != Greater && natural_order(&b, &c) != Greater {
                prop_assert_ne!(natural_order(&a, &c), Greater);
            }
        }

        #[test]
        fn a_counter_is_in_its_order(a in any::<u32>(), b in any::<u32>(), stem in "[a-z]{0,4}") {
            let name = |number: u32| format!("{stem}{number}.pcd");
            prop_assert_eq!(natural_order(&name(a), &name(b)), a.cmp(&b));
        }
    }
}
