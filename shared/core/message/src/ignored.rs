//! Candidates that are no object, and why.

use crate::pose::WirePose;
use bytemuck::{Pod, Zeroable};
use constraint::{Constraint, ConstraintSet, Finding, Findings, Reason, Truth};
use iceoryx2::prelude::ZeroCopySend;

/// Most ignored candidates in one summary.
pub const MAX_IGNORED: usize = 16;

/// What tells people most comes first: that a hand is a person says more than that
/// nothing carries it.
const MOST_TELLING: [Constraint; Constraint::N] = [
    Constraint::Robot,
    Constraint::Instructor,
    Constraint::Size,
    Constraint::Track,
    Constraint::Edge,
    Constraint::Table,
    Constraint::ImageBorder,
    Constraint::KeyView,
];

/// What one constraint says of one candidate.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.Finding.v1")]
#[repr(C)]
pub struct WireFinding {
    /// Number of a [`Truth`].
    pub truth: u16,
    /// Number of a [`Reason`].
    pub reason: u16,
    /// Values of the reason; zero where it has fewer.
    pub values: [f32; 2],
}

impl From<Finding> for WireFinding {
    fn from(finding: Finding) -> Self {
        Self {
            truth: finding.truth.code(),
            reason: finding.reason.code(),
            values: finding.reason.values(),
        }
    }
}

impl WireFinding {
    /// The finding; `None` when the numbers are not one.
    pub fn checked(&self) -> Option<Finding> {
        Some(Finding {
            truth: Truth::from_code(self.truth)?,
            reason: Reason::from_parts(self.reason, self.values)?,
        })
    }
}

/// A candidate that began no track and continued none.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.IgnoredBlob.v1")]
#[repr(C)]
pub struct IgnoredBlob {
    /// Pose of the box's centre: `world_from_box`.
    pub pose: WirePose,
    /// Full lengths of the box's sides, metres.
    pub size_m: [f32; 3],
    /// Measured points.
    pub n_points: u32,
    /// Number of a [`Truth`]: what the rule says of it.
    pub verdict: u32,
    /// Bits of the [`ConstraintSet`] that made the verdict what it is.
    pub decisive: u32,
    /// What each constraint says, by its number.
    pub findings: [WireFinding; Constraint::N],
}

const _: () = assert!(size_of::<WireFinding>() == 12 && size_of::<IgnoredBlob>() == 176);

impl IgnoredBlob {
    /// Writes down what every constraint says.
    pub fn wire_findings(findings: &Findings) -> [WireFinding; Constraint::N] {
        Constraint::ALL.map(|constraint| findings.of(constraint).into())
    }

    /// What the rule says of it; `None` when the number is none.
    pub fn verdict(&self) -> Option<Truth> {
        Truth::from_code(u16::try_from(self.verdict).ok()?)
    }

    /// What the constraints say that made the verdict what it is, the most telling
    /// first; those whose numbers are none are left out.
    pub fn why(&self) -> impl Iterator<Item = (Constraint, Finding)> {
        let decisive = ConstraintSet::from_bits(self.decisive as u8);
        let decided = MOST_TELLING
            .into_iter()
            .filter(move |constraint| decisive.contains(*constraint));
        decided.filter_map(|constraint| {
            let wire = self.findings.get(constraint as usize)?;
            Some((constraint, wire.checked()?))
        })
    }

    /// What every constraint says; those whose numbers are none are left out.
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

    fn blob() -> IgnoredBlob {
        let mut findings = Findings::default();
        let reason = Reason::Robot {
            share: 0.875,
            margin_m: 0.03,
        };
        let truth = Truth::True;
        findings.set(Constraint::Robot, Finding { truth, reason });
        IgnoredBlob {
            verdict: Truth::False.code().into(),
            decisive: ConstraintSet::from(Constraint::Robot).bits().into(),
            findings: IgnoredBlob::wire_findings(&findings),
            ..IgnoredBlob::default()
        }
    }

    #[test]
    fn verdict_and_reasons_survive_the_wire() {
        let blob = blob();
        assert_eq!(blob.verdict(), Some(Truth::False));
        let why: Vec<_> = blob.why().collect();
        assert_eq!(why.len(), 1);
        let (constraint, finding) = why[0];
        assert_eq!(
            (constraint, finding.truth),
            (Constraint::Robot, Truth::True)
        );
        assert!(
            finding.reason.to_string().contains("88 %"),
            "{}",
            finding.reason
        );
        assert_eq!(blob.findings().count(), Constraint::N);
    }

    #[test]
    fn torn_numbers_are_left_out() {
        let mut blob = blob();
        blob.findings[Constraint::Robot as usize].reason = 9999;
        blob.findings[0].truth = 7;
        blob.findings[1].values[0] = f32::NAN;
        blob.verdict = 0x0001_0000;
        assert_eq!(blob.verdict(), None);
        assert_eq!(blob.why().count(), 0);
        assert_eq!(blob.findings().count(), Constraint::N - 3);
    }
}
