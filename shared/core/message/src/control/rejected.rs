//! Reports on rejected candidates and on assumptions made for absent inputs.

use crate::RejectedCandidate;
use crate::control::rounding::rounded;
use constraint::{Assumption, Constraint, Finding, Ternary};
use serde::{Deserialize, Serialize};

/// Assumption made in place of an absent input.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AssumptionReport {
    /// Short name of the assumption, for scripts.
    pub name: String,
    /// Description of the assumption as a sentence.
    pub sentence: String,
}

impl From<Assumption> for AssumptionReport {
    fn from(assumption: Assumption) -> Self {
        Self {
            name: assumption.name().into(),
            sentence: assumption.sentence().into(),
        }
    }
}

/// Candidate above the table that the rule does not accept as an object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RejectedCandidateReport {
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
    pub findings: Vec<FindingReport>,
}

/// Finding of one constraint.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FindingReport {
    /// Name of the constraint in a rule.
    pub constraint: String,
    /// Truth value of the constraint: `true`, `false` or `unknown`.
    pub truth: String,
    /// Stable code of the finding's reason.
    pub reason: u16,
    /// Reason for the finding, as a sentence.
    pub sentence: String,
}

impl From<(Constraint, Finding)> for FindingReport {
    fn from((constraint, finding): (Constraint, Finding)) -> Self {
        Self {
            constraint: constraint.name().into(),
            truth: finding.value.word().into(),
            reason: finding.reason.code(),
            sentence: finding.reason.to_string(),
        }
    }
}

impl From<&RejectedCandidate> for RejectedCandidateReport {
    fn from(blob: &RejectedCandidate) -> Self {
        let decided = blob
            .decisive_findings()
            .map(|(_, finding)| finding.reason.to_string());
        let why = match blob.verdict() {
            Some(Ternary::True) => vec!["it is an object, but has no track-id yet".to_owned()],
            _ => decided.collect(),
        };
        Self {
            position_m: blob.pose.position_m,
            orientation_xyzw: blob.pose.orientation_xyzw,
            size_m: blob.size_m.map(rounded),
            n_points: blob.n_points,
            verdict: blob.verdict().unwrap_or(Ternary::Unknown).word().into(),
            why,
            findings: blob.findings().map(FindingReport::from).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::ObjectsReport;
    use crate::{SceneSummary, Text};
    use constraint::{Assumptions, Expression, Findings, Reason};

    fn summary() -> SceneSummary {
        let mut findings = Findings::default();
        let reason = Reason::AtRim {
            share: 0.4,
            distance_m: 0.03,
        };
        let truth = Ternary::True;
        findings.set(
            Constraint::Edge,
            Finding {
                value: truth,
                reason,
            },
        );
        let rule = Expression::paper();
        let mut assumptions = Assumptions::default();
        assumptions.add(Assumption::NoRobotKnown);
        let mut summary = SceneSummary {
            n_rejected: 20,
            n_ignored: 1,
            rule: Text::truncated(&rule.to_string()),
            assumptions: assumptions.bits(),
            ..SceneSummary::default()
        };
        summary.ignored[0] = RejectedCandidate {
            n_points: 320,
            verdict: rule.evaluate(&findings).code().into(),
            decisive: rule.decisive(&findings).bits().into(),
            findings: RejectedCandidate::wire_findings(&findings),
            ..RejectedCandidate::default()
        };
        summary
    }

    #[test]
    fn reports_give_the_reason_of_a_rejection() {
        let report = ObjectsReport::new(&summary(), &[], 0);
        assert_eq!(report.rule, Expression::paper().to_string());
        assert_eq!(report.assumptions[0].name, "no-robot-known");
        assert!(report.assumptions[0].sentence.contains("arm state"));
        assert_eq!((report.ignored.len(), report.n_more_ignored), (1, 19));
        let ignored = &report.ignored[0];
        assert_eq!((ignored.n_points, ignored.verdict.as_str()), (320, "false"));
        let sentence = "it is at the table's rim (40 % of its points nearer than 3 cm)";
        assert_eq!(ignored.why, [sentence]);
        assert_eq!(ignored.findings.len(), Constraint::N);
        let edge = &ignored.findings[Constraint::Edge as usize];
        assert_eq!(
            (edge.constraint.as_str(), edge.truth.as_str(), edge.reason),
            ("C_edge", "true", 51)
        );
    }
}
