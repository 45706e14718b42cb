//! Boolean expression over constraints, in postfix order and ternary logic.

use crate::parser::parse;
use crate::postfix_op::{N_NAMES_MAX, PostfixOp};
use crate::{Constraint, ConstraintSet, Findings, InvalidExpression, Ternary};
use std::fmt;
use std::str::FromStr;

/// Name of the default rule in place of an expression.
const DEFAULT_NAME: &str = "default";

/// Name of the paper's rule in place of an expression.
const PAPER_NAME: &str = "paper";

/// Boolean expression over constraints, evaluated in Kleene's ternary logic. The default is
/// `C_table ∧ C_track ∧ ¬(C_instructor ∨ C_robot)`, which loses nothing that stands on the
/// table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Expression {
    /// Postfix operations, which leave one value and hold at most [`N_NAMES_MAX`] names.
    ops: Vec<PostfixOp>,
}

impl Default for Expression {
    fn default() -> Self {
        Self::untracked_on_table(Constraint::Instructor, &[Constraint::Robot])
    }
}

/// Ternary value with the constraints that decided it.
#[derive(Debug, Clone, Copy)]
struct DecidedValue {
    truth: Ternary,
    decisive: ConstraintSet,
}

impl DecidedValue {
    const NONE: Self = Self {
        truth: Ternary::Unknown,
        decisive: ConstraintSet::NONE,
    };

    fn of(constraint: Constraint, findings: &Findings) -> Self {
        Self {
            truth: findings.get(constraint).value,
            decisive: constraint.into(),
        }
    }

    fn not(self) -> Self {
        Self {
            truth: self.truth.not(),
            ..self
        }
    }

    /// Combination of two values to `truth`, the value of at least one of them. The
    /// operands with that value have decided it.
    fn combined(self, other: Self, truth: Ternary) -> Self {
        let decisive = [self, other]
            .into_iter()
            .filter(|value| value.truth == truth)
            .fold(ConstraintSet::default(), |set, value| {
                set.union(value.decisive)
            });
        Self { truth, decisive }
    }
}

impl Expression {
    /// Rule of the paper (Kasaei et al. 2018):
    /// `C_table ∧ C_track ∧ ¬(C_instructor ∨ C_robot ∨ C_edge)`.
    pub fn paper() -> Self {
        Self::untracked_on_table(
            Constraint::Instructor,
            &[Constraint::Robot, Constraint::Edge],
        )
    }

    /// Rule `C_table ∧ C_track ∧ ¬(first ∨ …)` with the excluded constraints in their order.
    fn untracked_on_table(first: Constraint, others: &[Constraint]) -> Self {
        use PostfixOp::{And, Is, Not, Or};
        let mut ops = vec![Is(Constraint::Table), Is(Constraint::Track), And, Is(first)];
        ops.extend(others.iter().flat_map(|&other| [Is(other), Or]));
        ops.extend([Not, And]);
        Self { ops }
    }

    /// Evaluate the rule for the findings of a candidate. Allocates nothing.
    pub fn evaluate(&self, findings: &Findings) -> Ternary {
        self.value(findings).truth
    }

    /// Decisive constraints of an evaluation: among operands joined by "and" those of the
    /// least value, among operands joined by "or" those of the greatest.
    pub fn decisive(&self, findings: &Findings) -> ConstraintSet {
        self.value(findings).decisive
    }

    /// Constraints that the rule mentions.
    pub fn constraints(&self) -> ConstraintSet {
        let names = self.ops.iter().filter_map(|op| match op {
            PostfixOp::Is(constraint) => Some(ConstraintSet::from(*constraint)),
            _ => None,
        });
        names.fold(ConstraintSet::default(), ConstraintSet::union)
    }

    fn value(&self, findings: &Findings) -> DecidedValue {
        let mut stack = [DecidedValue::NONE; N_NAMES_MAX];
        // Stack index of the next value.
        let mut top = 0;
        for op in &self.ops {
            match op {
                PostfixOp::Is(constraint) => {
                    stack[top] = DecidedValue::of(*constraint, findings);
                    top += 1;
                }
                PostfixOp::Not => stack[top - 1] = stack[top - 1].not(),
                PostfixOp::And | PostfixOp::Or => {
                    let [left, right] = [stack[top - 2], stack[top - 1]];
                    let truth = if *op == PostfixOp::And {
                        left.truth.and(right.truth)
                    } else {
                        left.truth.or(right.truth)
                    };
                    top -= 1;
                    stack[top - 1] = left.combined(right, truth);
                }
            }
        }
        stack[0]
    }
}

impl FromStr for Expression {
    type Err = InvalidExpression;

    /// Parse a rule in the paper's notation (`∧ ∨ ¬`), with `and`, `or`, `not`, or with
    /// `&`, `|`, `!`; "not" binds tightest, then "and". The names `default` and `paper`
    /// stand for the [default](Self::default) and for the [paper's](Self::paper) rule.
    ///
    /// # Errors
    ///
    /// Quotes the rule and names the character at which it is invalid.
    fn from_str(text: &str) -> Result<Self, InvalidExpression> {
        match text.trim() {
            name if name.eq_ignore_ascii_case(DEFAULT_NAME) => Ok(Self::default()),
            name if name.eq_ignore_ascii_case(PAPER_NAME) => Ok(Self::paper()),
            text => parse(text).map(|ops| Self { ops }),
        }
    }
}

/// Operator precedence, loosest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Or,
    And,
    Atom,
}

/// Printed sub-expression with the precedence of its outermost operator.
struct PrintedTerm {
    text: String,
    binding: Binding,
}

impl PrintedTerm {
    fn atom(text: String) -> Self {
        Self {
            text,
            binding: Binding::Atom,
        }
    }

    /// Text in parentheses when it binds less tightly than its context.
    fn parenthesised(self, binding: Binding) -> String {
        if self.binding < binding {
            format!("({})", self.text)
        } else {
            self.text
        }
    }
}

impl fmt::Display for Expression {
    /// Print in the paper's notation with the fewest parentheses that preserve the
    /// expression.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts: Vec<PrintedTerm> = Vec::new();
        for op in &self.ops {
            let printed = match op {
                PostfixOp::Is(constraint) => PrintedTerm::atom(constraint.word().into()),
                PostfixOp::Not => {
                    let inner = pop(&mut parts).parenthesised(Binding::Atom);
                    PrintedTerm::atom(format!("¬{inner}"))
                }
                PostfixOp::And => {
                    let right = pop(&mut parts).parenthesised(Binding::Atom);
                    let left = pop(&mut parts).parenthesised(Binding::And);
                    PrintedTerm {
                        text: format!("{left} ∧ {right}"),
                        binding: Binding::And,
                    }
                }
                PostfixOp::Or => {
                    let right = pop(&mut parts).parenthesised(Binding::And);
                    let left = pop(&mut parts).parenthesised(Binding::Or);
                    PrintedTerm {
                        text: format!("{left} ∨ {right}"),
                        binding: Binding::Or,
                    }
                }
            };
            parts.push(printed);
        }
        f.write_str(&pop(&mut parts).text)
    }
}

/// Pop the last sub-expression; valid postfix operations never underflow.
fn pop(parts: &mut Vec<PrintedTerm>) -> PrintedTerm {
    parts
        .pop()
        .unwrap_or_else(|| PrintedTerm::atom(String::new()))
}

#[cfg(test)]
mod tests;
