//! Document of a rejected candidate, with the findings of all constraints.

use super::rounding::rounded;
use super::surface::name;
use crate::{RejectedCandidate, SceneSummary};
use constraint::{Constraint, Finding, Ternary};
use scene_document::{FindingDocument, RejectedDocument};

/// Document of a rejected candidate of a scene; its sentences name the surface under it.
pub(super) fn rejected(scene: &SceneSummary, candidate: &RejectedCandidate) -> RejectedDocument {
    let surface = name(scene, candidate);
    let decided = candidate
        .decisive_findings()
        .map(|(_, finding)| finding.reason.sentence(&surface));
    let verdict = candidate.verdict();
    let why = match verdict {
        Some(Ternary::True) => vec!["it is an object, but has no track-id yet".to_owned()],
        _ => decided.collect(),
    };
    RejectedDocument {
        position_m: candidate.pose.position_m,
        orientation_xyzw: candidate.pose.orientation_xyzw,
        size_m: candidate.size_m.map(rounded),
        n_points: candidate.n_points,
        verdict: verdict.unwrap_or(Ternary::Unknown).word().into(),
        why,
        findings: candidate
            .findings()
            .map(|one| finding(one, &surface))
            .collect(),
    }
}

fn finding((constraint, finding): (Constraint, Finding), surface: &str) -> FindingDocument {
    FindingDocument {
        constraint: constraint.word().into(),
        truth: finding.value.word().into(),
        reason: finding.reason.code(),
        sentence: finding.reason.sentence(surface),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SurfaceKind, Text, WireSurface, document};
    use constraint::{Assumption, Assumptions, Expression, Findings, Reason};

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
        let report = document::scene(&summary(), &[], 0);
        assert_eq!(report.rule, Expression::paper().to_string());
        assert_eq!(report.assumptions[0].name, "no-robot-known");
        assert!(report.assumptions[0].sentence.contains("arm state"));
        assert_eq!((report.ignored.len(), report.n_more_ignored), (1, 19));
        let ignored = &report.ignored[0];
        assert_eq!((ignored.n_points, ignored.verdict.as_str()), (320, "false"));
        let sentence = "it is at the rim of the table (40 % of its points nearer than 3 cm)";
        assert_eq!(ignored.why, [sentence]);
        assert_eq!(ignored.findings.len(), Constraint::N);
        let edge = &ignored.findings[Constraint::Edge as usize];
        assert_eq!(
            (edge.constraint.as_str(), edge.truth.as_str(), edge.reason),
            ("C_edge", "true", 51)
        );
    }

    #[test]
    fn reports_name_the_surface_of_a_rejected_candidate() {
        let mut scene = summary();
        let surface = |kind: SurfaceKind, height_m: f64| WireSurface {
            plane: [0.0, 0.0, 1.0, -height_m],
            kind: kind.code(),
            ..WireSurface::default()
        };
        scene.n_surfaces = 2;
        scene.surfaces[0] = surface(SurfaceKind::Table, 0.7);
        scene.surfaces[1] = surface(SurfaceKind::Level, 1.1);
        for (index, name) in [
            (0, "the table"),
            (1, "the level 40 cm above the table"),
            (9, "the table"),
        ] {
            scene.ignored[0].surface = index;
            let report = document::scene(&scene, &[], 0);
            let expected =
                format!("it is at the rim of {name} (40 % of its points nearer than 3 cm)");
            assert_eq!(report.ignored[0].why, [expected]);
        }
    }
}
