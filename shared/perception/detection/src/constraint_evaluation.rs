//! Constraint evaluation: ternary findings for each candidate.

mod body_mask;
mod box_iou;
mod constraint_evaluator;

pub(crate) use body_mask::{BodyMask, is_expected};
pub(crate) use constraint_evaluator::ConstraintEvaluator;
