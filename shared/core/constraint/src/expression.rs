//! A rule over constraints.

use crate::parser::parse;
use crate::{Constraint, ConstraintSet, Findings, InvalidExpression, Truth};
use std::fmt;
use std::str::FromStr;

/// Most names in a rule; with this many no value waits deeper than that.
pub(crate) const N_NAMES_MAX: usize = 32;

/// One step of a rule in postfix order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// What a constraint says.
    Is(Constraint),
    /// The contrary of the last value.
    Not,
    /// The last two values, both.
    And,
    /// The last two values, either.
    Or,
}

/// A boolean expression over constraints. The default is that of the paper,
/// `C_table ∧ C_track ∧ ¬(C_instructor ∨ C_robot ∨ C_edge)`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Expression {
    steps: Vec<Step>,
}

impl Default for Expression {
    fn default() -> Self {
        use Constraint::{Edge, Instructor, Robot, Table, Track};
        use Step::{And, Is, Not, Or};
        let steps = vec![
            Is(Table),
            Is(Track),
            And,
            Is(Instructor),
            Is(Robot),
            Or,
            Is(Edge),
            Or,
            Not,
            And,
        ];
        Self { steps }
    }
}

/// A value with the constraints that made it so.
#[derive(Debug, Clone, Copy)]
struct Value {
    truth: Truth,
    decisive: ConstraintSet,
}

impl Value {
    const NONE: Self = Self {
        truth: Truth::Unknown,
        decisive: ConstraintSet::NONE,
    };

    fn of(constraint: Constraint, findings: &Findings) -> Self {
        Self {
            truth: findings.of(constraint).truth,
            decisive: constraint.into(),
        }
    }

    fn not(self) -> Self {
        Self {
            truth: self.truth.not(),
            ..self
        }
    }

    /// Two values joined to `truth`, which is that of one of them at least: those
    /// that have it have decided it.
    fn joined(self, other: Self, truth: Truth) -> Self {
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
    /// Of steps in postfix order, which must leave one value and hold at most
    /// [`N_NAMES_MAX`] names.
    pub(crate) fn from_steps(steps: Vec<Step>) -> Self {
        Self { steps }
    }

    /// What the rule says of a candidate. Allocates nothing.
    pub fn evaluate(&self, findings: &Findings) -> Truth {
        self.value(findings).truth
    }

    /// The constraints whose findings make the rule say what it says: of those
    /// joined by "and" the least true, of those joined by "or" the truest.
    pub fn decisive(&self, findings: &Findings) -> ConstraintSet {
        self.value(findings).decisive
    }

    /// The constraints it names.
    pub fn constraints(&self) -> ConstraintSet {
        let names = self.steps.iter().filter_map(|step| match step {
            Step::Is(constraint) => Some(ConstraintSet::from(*constraint)),
            _ => None,
        });
        names.fold(ConstraintSet::default(), ConstraintSet::union)
    }

    fn value(&self, findings: &Findings) -> Value {
        let mut stack = [Value::NONE; N_NAMES_MAX];
        // Where the next value goes.
        let mut top = 0;
        for step in &self.steps {
            match step {
                Step::Is(constraint) => {
                    stack[top] = Value::of(*constraint, findings);
                    top += 1;
                }
                Step::Not => stack[top - 1] = stack[top - 1].not(),
                Step::And | Step::Or => {
                    let [left, right] = [stack[top - 2], stack[top - 1]];
                    let truth = if *step == Step::And {
                        left.truth.and(right.truth)
                    } else {
                        left.truth.or(right.truth)
                    };
                    top -= 1;
                    stack[top - 1] = left.joined(right, truth);
                }
            }
        }
        stack[0]
    }
}

impl FromStr for Expression {
    type Err = InvalidExpression;

    /// Reads a rule in the paper's notation or with `and`, `or`, `not`, or with
    /// `&`, `|`, `!`; "not" binds closest, then "and".
    fn from_str(text: &str) -> Result<Self, InvalidExpression> {
        parse(text)
    }
}

/// How closely an operator binds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Or,
    And,
    Closest,
}

/// A printed part with the binding of its outermost operator.
struct Printed {
    text: String,
    binding: Binding,
}

impl Printed {
    fn closest(text: String) -> Self {
        Self {
            text,
            binding: Binding::Closest,
        }
    }

    /// In parentheses when it binds less closely than what is around it.
    fn within(self, binding: Binding) -> String {
        if self.binding < binding {
            format!("({})", self.text)
        } else {
            self.text
        }
    }
}

impl fmt::Display for Expression {
    /// The paper's notation, with no more parentheses than are needed to read
    /// the same expression again.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts: Vec<Printed> = Vec::new();
        for step in &self.steps {
            let printed = match step {
                Step::Is(constraint) => Printed::closest(constraint.name().into()),
                Step::Not => {
                    let inner = pop(&mut parts).within(Binding::Closest);
                    Printed::closest(format!("¬{inner}"))
                }
                Step::And => {
                    let right = pop(&mut parts).within(Binding::Closest);
                    let left = pop(&mut parts).within(Binding::And);
                    Printed {
                        text: format!("{left} ∧ {right}"),
                        binding: Binding::And,
                    }
                }
                Step::Or => {
                    let right = pop(&mut parts).within(Binding::And);
                    let left = pop(&mut parts).within(Binding::Or);
                    Printed {
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

/// The last part; steps in postfix order never ask for one too many.
fn pop(parts: &mut Vec<Printed>) -> Printed {
    parts
        .pop()
        .unwrap_or_else(|| Printed::closest(String::new()))
}

#[cfg(test)]
mod tests;
