//! Evaluation of the constraints: three-valued findings for each candidate.

mod box_overlap;
mod judge;
mod limbs;

pub(crate) use judge::Judge;
pub(crate) use limbs::Limbs;
