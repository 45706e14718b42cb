//! Document of a rejected candidate, with the findings of all constraints.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Candidate above the table that the rule does not accept as an object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RejectedDocument {
    /// Centre of the box in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box in the world, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Side lengths of the candidate's box, metres.
    pub size_m: [f64; 3],
    /// Number of measured points of the candidate.
    pub n_points: u32,
    /// Verdict of the rule: `false` or `unknown`; `true` while no track-id is available.
    pub verdict: String,
    /// Reasons that decided the verdict, as sentences.
    pub why: Vec<String>,
    /// Findings of all constraints about the candidate.
    pub findings: Vec<FindingDocument>,
}

/// Finding of one constraint.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FindingDocument {
    /// Name of the constraint in a rule.
    pub constraint: String,
    /// Truth value of the constraint: `true`, `false` or `unknown`.
    pub truth: String,
    /// Stable code of the finding's reason.
    pub reason: u16,
    /// Reason for the finding, as a sentence.
    pub sentence: String,
}
