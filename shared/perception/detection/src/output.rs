//! Detection output: the table, the candidates and the assumptions made.

use crate::candidate::Candidate;
use crate::table::Table;
use constraint::Assumptions;

/// Detection output of one frame. Reused from frame to frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Detection {
    /// Table; without one there are no candidates.
    pub table: Option<Table>,
    /// All clusters with enough points, nearest first, including those that the rule
    /// rejects.
    pub candidates: Vec<Candidate>,
    /// Assumptions made in place of absent sources.
    pub assumptions: Assumptions,
    /// Indices of the candidates' points in the cloud: candidate by candidate, in the
    /// order of the cloud within each.
    pub point_indices: Vec<u32>,
}

impl Detection {
    /// Indices of a candidate's points in the cloud.
    pub fn points_of(&self, candidate: &Candidate) -> &[u32] {
        &self.point_indices[candidate.range.clone()]
    }
}
