//! Syntax error of a constraint rule, with position and suggestion.

use crate::Constraint;
use std::fmt;

/// Greatest number of characters of a rule quoted in an error.
const N_QUOTED: usize = 160;

/// Syntax error of a constraint rule.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InvalidExpression {
    /// Quoted rule, truncated when long.
    quoted: String,
    /// Position of the fault, characters, counted from 1.
    character: usize,
    fault: SyntaxFault,
}

/// Kind of syntax fault at a position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum SyntaxFault {
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
    /// An operand is missing: a name, "not" or "(" is required; holds the token found
    /// instead.
    OperandMissing(Option<String>),
    /// An operator is missing: "and", "or" or the end is required; holds the token found
    /// instead.
    OperatorMissing(String),
    NotClosed,
}

impl InvalidExpression {
    /// Error for a fault at byte offset `at` of `text`.
    pub(crate) fn new(text: &str, at: usize, fault: SyntaxFault) -> Self {
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
            SyntaxFault::Empty => {
                return write!(
                    f,
                    "the rule is empty; it must name constraints, for example: C_table and C_track"
                );
            }
            SyntaxFault::TooLong { n_bytes_max } => {
                return write!(
                    f,
                    "the rule {quoted:?} is longer than {n_bytes_max} bytes; write a shorter one"
                );
            }
            _ => write!(
                f,
                "the rule {quoted:?} cannot be read at character {character}: "
            )?,
        }
        match fault {
            SyntaxFault::Empty | SyntaxFault::TooLong { .. } => Ok(()),
            SyntaxFault::TooManyNames { n_max } => {
                write!(
                    f,
                    "it names more than {n_max} constraints; write a shorter one"
                )
            }
            SyntaxFault::TooDeep { depth_max } => write!(
                f,
                "more than {depth_max} parentheses and \"not\" are open; write a flatter one"
            ),
            SyntaxFault::UnknownConstraint(name) => fmt_unknown_constraint(f, name),
            SyntaxFault::StrangeCharacter(strange) => write!(
                f,
                "{strange:?} has no meaning; use names, parentheses, and, or, not, or the signs \
                 & | ! ∧ ∨ ¬"
            ),
            SyntaxFault::OperandMissing(None) => {
                f.write_str("it ends where a constraint is needed; name one, or leave the rest out")
            }
            SyntaxFault::OperandMissing(Some(found)) => {
                write!(
                    f,
                    "a constraint is needed where {found:?} stands; name one before it"
                )
            }
            SyntaxFault::OperatorMissing(found) => {
                write!(f, "\"and\" or \"or\" is needed before {found:?}")
            }
            SyntaxFault::NotClosed => {
                f.write_str("the parenthesis that is opened here is not closed; add a \")\"")
            }
        }
    }
}

impl std::error::Error for InvalidExpression {}

fn fmt_unknown_constraint(f: &mut fmt::Formatter<'_>, name: &str) -> fmt::Result {
    write!(f, "there is no constraint {name:?}")?;
    if let Some(near) = closest_name(name) {
        write!(f, ", {} may be meant", near.word())?;
    }
    f.write_str("; there are ")?;
    let names: Vec<_> = Constraint::ALL.into_iter().map(Constraint::word).collect();
    f.write_str(&names.join(", "))
}

/// Spelling suggestion: the constraint with the smallest edit distance, at most a third of
/// the length of its name.
fn closest_name(name: &str) -> Option<Constraint> {
    let name = name.to_ascii_lowercase();
    let name = name.strip_prefix("c_").unwrap_or(&name);
    let differing = |constraint: &Constraint| edit_distance(name, &constraint.word()[2..]);
    let near = Constraint::ALL.into_iter().min_by_key(differing)?;
    (3 * differing(&near) <= near.word().len()).then_some(near)
}

/// Levenshtein distance (1966): number of inserted, removed or replaced letters. Compares
/// at most 32 letters of `a`.
fn edit_distance(a: &str, b: &str) -> usize {
    let a: String = a.chars().take(32).collect();
    strsim::levenshtein(&a, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distance_counts_edits() {
        for (a, b, n) in [
            ("", "edge", 4),
            ("edge", "edge", 0),
            ("egde", "edge", 2),
            ("tabel", "table", 2),
            ("tables", "table", 1),
        ] {
            assert_eq!(edit_distance(a, b), n, "{a} {b}");
        }
    }

    #[test]
    fn spelling_suggestion_needs_a_close_name() {
        assert_eq!(closest_name("C_tabel"), Some(Constraint::Table));
        assert_eq!(closest_name("ROBOTS"), Some(Constraint::Robot));
        assert_eq!(closest_name("keyview"), Some(Constraint::KeyView));
        assert_eq!(closest_name("C_unicorn"), None);
    }
}
