//! Detection output: the table, the candidates and the assumptions made.

use crate::body_map::BodyMap;
use crate::candidate::Candidate;
use crate::table::Table;
use constraint::Assumptions;
use sensor_noise::DepthNoise;

/// Detection output of one frame. Reused from frame to frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Detection {
    /// Support surfaces: the table, then further levels that carry objects, then the others;
    /// without any there are no candidates.
    pub surfaces: Vec<Table>,
    /// Configured depth noise law of the camera; the table has the ratio of its noise to it.
    pub depth_noise: DepthNoise,
    /// All clusters with enough points, surface by surface and nearest first on each, including
    /// those that the rule rejects.
    pub candidates: Vec<Candidate>,
    /// Bodies found in depth; empty when people are known.
    pub bodies: BodyMap,
    /// Assumptions made in place of absent sources.
    pub assumptions: Assumptions,
    /// Indices of the candidates' points in the cloud: candidate by candidate, in the
    /// order of the cloud within each.
    pub point_indices: Vec<u32>,
}

impl Detection {
    /// Table: the surface on which objects are looked for first.
    pub fn table(&self) -> Option<&Table> {
        self.surfaces.first()
    }

    /// Indices of a candidate's points in the cloud.
    pub fn points_of(&self, candidate: &Candidate) -> &[u32] {
        &self.point_indices[candidate.range.clone()]
    }
}
