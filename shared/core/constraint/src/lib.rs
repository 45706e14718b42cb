//! Three-valued constraints on object candidates and the Boolean rule over them.
//!
//! A [`Constraint`] is a predicate about a candidate, for example "stands on the
//! table". Its [`Finding`] is true, false or unknown, with a [`Reason`]. An
//! [`Expression`], ψ in the paper, is a Boolean rule over the constraints in Kleene's
//! strong ternary logic; only a candidate for which it is true begins a track.
//! [`Assumptions`] name the sources that were absent.
//!
//! Invariants: this crate depends on no other crate of the workspace, knows neither
//! points nor images, does no I/O, and accepts any text as a rule and any number from
//! the wire without a panic. Codes and bits on the wire are never reused.
//!
//! # Example
//!
//! ```
//! use constraint::{Constraint, Expression, Finding, Findings, Reason, Ternary};
//!
//! let rule: Expression = "C_table and not C_edge".parse()?;
//! let mut findings = Findings::default();
//! let standing = Finding { value: Ternary::True, reason: Reason::StandsOnTable };
//! findings.set(Constraint::Table, standing);
//! // The rim has not been evaluated, so the verdict is open.
//! assert_eq!(rule.evaluate(&findings), Ternary::Unknown);
//!
//! let inside = Finding { value: Ternary::False, reason: Reason::AwayFromRim };
//! findings.set(Constraint::Edge, inside);
//! assert_eq!(rule.evaluate(&findings), Ternary::True);
//! # Ok::<(), constraint::InvalidExpression>(())
//! ```

mod assumption;
mod constraint;
mod constraint_set;
mod expression;
mod finding;
mod findings;
mod invalid_expression;
mod parser;
mod postfix_op;
mod reason;
mod ternary;

pub use assumption::{Assumption, Assumptions};
pub use constraint::Constraint;
pub use constraint_set::ConstraintSet;
pub use expression::Expression;
pub use finding::Finding;
pub use findings::Findings;
pub use invalid_expression::InvalidExpression;
pub use reason::Reason;
pub use ternary::Ternary;
