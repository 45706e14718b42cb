//! Evidence of a candidate for an object of its own, from the constraints and its neighbours.

use constraint::{Constraint, ConstraintSet, Ternary};
use detection::Candidate;
use tracking::{SightingEvidence, fraction_inside};

/// Largest horizontal distance of a candidate's centre from the box of a larger one of which
/// it may be a part, metres: the outer half of a mug's handle. Chosen.
const PART_DISTANCE_MAX_M: f64 = 0.045;

/// Evidence of a candidate among all candidates of its frame.
pub(crate) fn sighting_evidence(
    candidate: &Candidate,
    candidates: &[Candidate],
) -> SightingEvidence {
    if !could_begin_track(candidate) {
        SightingEvidence::Contrary
    } else if candidates.iter().any(|other| adjoins(candidate, other)) {
        SightingEvidence::Adjoining
    } else {
        SightingEvidence::Separate
    }
}

/// True if no constraint speaks against a new track but that the object is tracked already.
fn could_begin_track(candidate: &Candidate) -> bool {
    let is_tracked = candidate.decisive == ConstraintSet::from(Constraint::Track);
    match candidate.verdict {
        Ternary::True => true,
        Ternary::False => is_tracked,
        Ternary::Unknown => false,
    }
}

/// True if a candidate is in contact with a larger one, or so close that it may be a part
/// whose joint has no depth.
fn adjoins(part: &Candidate, whole: &Candidate) -> bool {
    let centre = part.oriented_box.centre();
    let place = whole.oriented_box.frame_from_box.inverse() * centre;
    let half = whole.oriented_box.half_sides_m;
    let is_close = place.x.abs() <= half.x + PART_DISTANCE_MAX_M
        && place.y.abs() <= half.y + PART_DISTANCE_MAX_M
        && place.z.abs() <= half.z;
    part.n_points() < whole.n_points()
        && (is_close || fraction_inside(&part.oriented_box, &whole.oriented_box) > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use constraint::Findings;
    use geometry::{OrientedBox, RigidTransform};
    use nalgebra::{Point3, Vector3};
    use tracking::SightingEvidence::{Adjoining, Contrary, Separate};

    fn candidate(x: f64, half_m: f64, n_points: usize) -> Candidate {
        Candidate {
            range: 0..n_points,
            surface: 0,
            centroid: Point3::new(x, 0.0, 0.8),
            oriented_box: OrientedBox {
                frame_from_box: RigidTransform::translation(x, 0.0, 0.8),
                half_sides_m: Vector3::repeat(half_m),
            },
            occluded_base_m: 0.0,
            mean_rgb: [120.0; 3],
            support: None,
            touches_image_border: false,
            is_object_sized: true,
            findings: Findings::default(),
            verdict: Ternary::True,
            decisive: ConstraintSet::NONE,
        }
    }

    #[test]
    fn evidence_of_a_cluster_beside_a_larger_one_is_weak() {
        let (mug, handle) = (candidate(0.0, 0.05, 2000), candidate(0.08, 0.02, 150));
        let both = [mug.clone(), handle.clone()];
        assert_eq!(sighting_evidence(&mug, &both), Separate);
        assert_eq!(sighting_evidence(&handle, &both), Adjoining);
        assert_eq!(
            sighting_evidence(&handle, std::slice::from_ref(&handle)),
            Separate
        );
        let apart = candidate(0.2, 0.02, 150);
        assert_eq!(sighting_evidence(&apart, &both), Separate);
    }

    #[test]
    fn evidence_of_a_cluster_against_the_rule_is_contrary_unless_it_is_tracked() {
        let judged = |verdict, decisive: Constraint| {
            let mut judged = candidate(0.0, 0.05, 2000);
            (judged.verdict, judged.decisive) = (verdict, decisive.into());
            sighting_evidence(&judged, &[])
        };
        assert_eq!(judged(Ternary::False, Constraint::Track), Separate);
        assert_eq!(judged(Ternary::False, Constraint::Edge), Contrary);
        assert_eq!(judged(Ternary::Unknown, Constraint::Track), Contrary);
    }
}
