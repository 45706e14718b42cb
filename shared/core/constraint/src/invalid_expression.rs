//! Why a rule can not be read.

use crate::Constraint;
use std::fmt;

/// Characters of a rule that an error repeats.
const N_QUOTED: usize = 160;

/// A rule that can not be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InvalidExpression {
    /// The rule, cut when it is long.
    quoted: String,
    /// Place of what is wrong, characters from 1.
    character: usize,
    fault: Fault,
}

/// What is wrong at a place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Fault {
    Empty,
    TooLong {
        n_bytes_max: usize,
    },
    TooManyNames {
        n_max: usize,
    },
    TooDeep {
        depth_max: usize,
    },
    UnknownConstraint(String),
    StrangeCharacter(char),
    /// A name, "not" or "(" is needed; what is there instead, if anything.
    OperandMissing(Option<String>),
    /// "and", "or" or the end is needed.
    OperatorMissing(String),
    NotClosed,
}

impl InvalidExpression {
    /// `at` is a byte's place in `text`.
    pub(crate) fn new(text: &str, at: usize, fault: Fault) -> Self {
        let character = text.char_indices().take_while(|(i, _)| *i < at).count() + 1;
        let mut quoted: String = text.chars().take(N_QUOTED).collect();
        if quoted.len() < text.len() {
            quoted.push('…');
        }
        Self {
            quoted,
            character,
            fault,
        }
    }
}

impl fmt::Display for InvalidExpression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            quoted,
            character,
            fault,
        } = self;
        match fault {
            Fault::Empty => {
                return write!(
                    f,
                    "the rule is empty; it must name constraints, for example: C_table and C_track"
                );
            }
            Fault::TooLong { n_bytes_max } => {
                return write!(
                    f,
                    "the rule {quoted:?} is longer than {n_bytes_max} bytes; write a shorter one"
                );
            }
            _ => write!(
                f,
                "the rule {quoted:?} can not be read at character {character}: "
            )?,
        }
        match fault {
            Fault::Empty | Fault::TooLong { .. } => Ok(()),
            Fault::TooManyNames { n_max } => {
                write!(
                    f,
                    "it names more than {n_max} constraints; write a shorter one"
                )
            }
            Fault::TooDeep { depth_max } => write!(
                f,
                "more than {depth_max} parentheses and \"not\" are open; write a flatter one"
            ),
            Fault::UnknownConstraint(name) => unknown(f, name),
            Fault::StrangeCharacter(strange) => write!(
                f,
                "{strange:?} has no meaning; use names, parentheses, and, or, not, or the signs \
                 & | ! ∧ ∨ ¬"
            ),
            Fault::OperandMissing(None) => {
                f.write_str("it ends where a constraint is needed; name one, or leave the rest out")
            }
            Fault::OperandMissing(Some(found)) => {
                write!(
                    f,
                    "a constraint is needed where {found:?} stands; name one before it"
                )
            }
            Fault::OperatorMissing(found) => {
                write!(f, "\"and\" or \"or\" is needed before {found:?}")
            }
            Fault::NotClosed => {
                f.write_str("the parenthesis that is opened here is not closed; add a \")\"")
            }
        }
    }
}

impl std::error::Error for InvalidExpression {}

fn unknown(f: &mut fmt::Formatter<'_>, name: &str) -> fmt::Result {
    write!(f, "there is no constraint {name:?}")?;
    if let Some(near) = nearest(name) {
        write!(f, ", {} may be meant", near.name())?;
    }
    f.write_str("; there are ")?;
    let names: Vec<_> = Constraint::ALL.into_iter().map(Constraint::name).collect();
    f.write_str(&names.join(", "))
}

/// The constraint whose name differs by the fewest letters, a third at most.
fn nearest(name: &str) -> Option<Constraint> {
    let name = name.to_ascii_lowercase();
    let name = name.strip_prefix("c_").unwrap_or(&name);
    let differing = |constraint: &Constraint| n_edits(name, &constraint.name()[2..]);
    let near = Constraint::ALL.into_iter().min_by_key(differing)?;
    (3 * differing(&near) <= near.name().len()).then_some(near)
}

/// Letters to be put in, taken out or replaced (Levenshtein 1966). A long name
/// is no near one and is not looked at beyond 32 letters.
fn n_edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().take(32).enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, other) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != *other);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_counted() {
        for (a, b, n) in [
            ("", "edge", 4),
            ("edge", "edge", 0),
            ("egde", "edge", 2),
            ("tabel", "table", 2),
            ("tables", "table", 1),
        ] {
            assert_eq!(n_edits(a, b), n, "{a} {b}");
        }
    }

    #[test]
    fn a_near_name_is_offered_and_a_far_one_is_not() {
        assert_eq!(nearest("C_tabel"), Some(Constraint::Table));
        assert_eq!(nearest("ROBOTS"), Some(Constraint::Robot));
        assert_eq!(nearest("keyview"), Some(Constraint::KeyView));
        assert_eq!(nearest("C_unicorn"), None);
    }
}
