//! Rejected candidates: detections that are no objects, with the reasons.

use crate::pose::WirePose;
use bytemuck::{Pod, Zeroable};
use constraint::{Constraint, ConstraintSet, Finding, Findings, Reason, Ternary};
use iceoryx2::prelude::ZeroCopySend;

/// Maximum number of rejected candidates in one scene summary.
pub const MAX_REJECTED_CANDIDATES: usize = 16;

/// Order in which reasons are reported, most informative first.
const REPORT_ORDER: [Constraint; Constraint::N] = [
    Constraint::Robot,
    Constraint::Instructor,
    Constraint::Size,
    Constraint::Track,
    Constraint::Edge,
    Constraint::Table,
    Constraint::ImageBorder,
    Constraint::KeyView,
];

/// Finding of one constraint on one candidate.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.Finding.v1")]
#[repr(C)]
pub struct WireFinding {
    /// Truth value of the finding: code of a [`Ternary`] value.
    pub truth: u16,
    /// Reason of the finding: code of a [`Reason`].
    pub reason: u16,
    /// Parameters of the reason; unused ones are zero.
    pub values: [f32; 2],
}

impl From<Finding> for WireFinding {
    fn from(finding: Finding) -> Self {
        Self {
            truth: finding.value.code(),
            reason: finding.reason.code(),
            values: finding.reason.values(),
        }
    }
}

impl WireFinding {
    /// Validated finding; `None` for unknown codes.
    pub fn checked(&self) -> Option<Finding> {
        Some(Finding {
            value: Ternary::from_code(self.truth)?,
            reason: Reason::from_parts(self.reason, self.values)?,
        })
    }
}

/// Candidate that neither started nor continued a track.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.IgnoredBlob.v2")]
#[repr(C)]
pub struct RejectedCandidate {
    /// Pose of the candidate's box: `world_from_box`.
    pub pose: WirePose,
    /// Side lengths of the candidate's box, metres.
    pub size_m: [f32; 3],
    /// Number of measured points of the candidate.
    pub n_points: u32,
    /// Verdict of the rule: code of a [`Ternary`] value.
    pub verdict: u32,
    /// Bits of the [`ConstraintSet`] that decided the verdict.
    pub decisive: u32,
    /// Findings of all constraints, indexed by constraint number.
    pub findings: [WireFinding; Constraint::N],
    /// Surface on or over which it was found: index among those of the scene.
    pub surface: u32,
    /// 0.
    pub reserved: u32,
}

const _: () = assert!(size_of::<WireFinding>() == 12 && size_of::<RejectedCandidate>() == 184);

impl RejectedCandidate {
    /// Wire form of the findings of all constraints.
    pub fn wire_findings(findings: &Findings) -> [WireFinding; Constraint::N] {
        Constraint::ALL.map(|constraint| findings.get(constraint).into())
    }

    /// Verdict of the rule; `None` for an unknown code.
    pub fn verdict(&self) -> Option<Ternary> {
        Ternary::from_code(u16::try_from(self.verdict).ok()?)
    }

    /// Findings of the constraints that decided the verdict, most informative first. Invalid
    /// findings are skipped.
    pub fn decisive_findings(&self) -> impl Iterator<Item = (Constraint, Finding)> {
        let decisive = ConstraintSet::from_bits(self.decisive as u8);
        let decided = REPORT_ORDER
            .into_iter()
            .filter(move |constraint| decisive.contains(*constraint));
        decided.filter_map(|constraint| {
            let wire = self.findings.get(constraint as usize)?;
            Some((constraint, wire.checked()?))
        })
    }

    /// Findings of all constraints. Invalid findings are skipped.
    pub fn findings(&self) -> impl Iterator<Item = (Constraint, Finding)> {
        Constraint::ALL
            .into_iter()
            .zip(&self.findings)
            .filter_map(|(constraint, wire)| Some((constraint, wire.checked()?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate() -> RejectedCandidate {
        let mut findings = Findings::default();
        let reason = Reason::Robot {
            share: 0.875,
            margin_m: 0.03,
        };
        let truth = Ternary::True;
        findings.set(
            Constraint::Robot,
            Finding {
                value: truth,
                reason,
            },
        );
        RejectedCandidate {
            verdict: Ternary::False.code().into(),
            decisive: ConstraintSet::from(Constraint::Robot).bits().into(),
            findings: RejectedCandidate::wire_findings(&findings),
            ..RejectedCandidate::default()
        }
    }

    #[test]
    fn verdict_and_reasons_survive_the_wire() {
        let candidate = candidate();
        assert_eq!(candidate.verdict(), Some(Ternary::False));
        let why: Vec<_> = candidate.decisive_findings().collect();
        assert_eq!(why.len(), 1);
        let (constraint, finding) = why[0];
        assert_eq!(
            (constraint, finding.value),
            (Constraint::Robot, Ternary::True)
        );
        assert!(
            finding.reason.to_string().contains("88 %"),
            "{}",
            finding.reason
        );
        assert_eq!(candidate.findings().count(), Constraint::N);
    }

    #[test]
    fn torn_findings_are_skipped() {
        let mut candidate = candidate();
        candidate.findings[Constraint::Robot as usize].reason = 9999;
        candidate.findings[0].truth = 7;
        candidate.findings[1].values[0] = f32::NAN;
        candidate.verdict = 0x0001_0000;
        assert_eq!(candidate.verdict(), None);
        assert_eq!(candidate.decisive_findings().count(), 0);
        assert_eq!(candidate.findings().count(), Constraint::N - 3);
    }
}
