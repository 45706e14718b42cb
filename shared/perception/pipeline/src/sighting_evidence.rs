//! Evidence of a candidate for an object of its own, from the constraints and its neighbours.

use constraint::{Constraint, ConstraintSet, Ternary};
use detection::{Candidate, Support};
use tracking::{SightingEvidence, fraction_inside};

/// Largest horizontal distance of a candidate's centre from the box of a larger one beside which
/// it stands, metres: the outer half of a mug's handle. Chosen.
const ADJOINING_DISTANCE_MAX_M: f64 = 0.045;

/// Point-count ratio below which a candidate may be a part of a larger one. Chosen.
const PART_POINTS_RATIO_MAX: f64 = 0.12;

/// Largest horizontal distance of a part's centre from the box of the larger candidate,
/// metres. Chosen.
const PART_DISTANCE_MAX_M: f64 = 0.035;

/// As [`PART_DISTANCE_MAX_M`], of a part whose lower border the larger candidate may hide, such as
/// the tip of a spout behind its pot. Chosen.
const HIDDEN_PART_DISTANCE_MAX_M: f64 = 0.075;

/// Largest Euclidean distance between the mean colours of a part and the larger
/// candidate, per channel 0 to 255. Chosen.
const PART_COLOR_DISTANCE_MAX: f32 = 45.0;

/// Evidence of a candidate among all candidates of its frame.
pub(crate) fn sighting_evidence(
    candidate: &Candidate,
    candidates: &[Candidate],
) -> SightingEvidence {
    if !could_begin_track(candidate) || is_part_of_larger(candidate, candidates) {
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
    part.n_points() < whole.n_points()
        && (is_beside(part, whole, ADJOINING_DISTANCE_MAX_M)
            || fraction_inside(&part.oriented_box, &whole.oriented_box) > 0.0)
}

/// True if the centre of a candidate is within a horizontal distance of the box of another one, at
/// a height of that box.
fn is_beside(candidate: &Candidate, other: &Candidate, distance_max_m: f64) -> bool {
    let centre = candidate.oriented_box.centre();
    let place = other.oriented_box.frame_from_box.inverse() * centre;
    let half = other.oriented_box.half_sides_m;
    place.x.abs() <= half.x + distance_max_m
        && place.y.abs() <= half.y + distance_max_m
        && place.z.abs() <= half.z
}

/// True if a candidate is probably a detached part of a larger one, such as a mug's
/// handle without depth at its joint: few points, similar colour, close, and not
/// supported by the table.
fn is_part_of_larger(part: &Candidate, candidates: &[Candidate]) -> bool {
    let is_like = |whole: &Candidate| {
        let pairs = part.mean_rgb.iter().zip(whole.mean_rgb);
        let squares = pairs.map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f32>().sqrt() <= PART_COLOR_DISTANCE_MAX
    };
    let distance_max_m = match part.support {
        Some(Support::Table) => return false,
        Some(Support::Occluded) => HIDDEN_PART_DISTANCE_MAX_M,
        Some(Support::Object) | None => PART_DISTANCE_MAX_M,
    };
    candidates.iter().any(|whole| {
        part.n_points() as f64 <= PART_POINTS_RATIO_MAX * whole.n_points() as f64
            && is_beside(part, whole, distance_max_m)
            && is_like(whole)
    })
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
        let (mug, handle) = (candidate(0.0, 0.05, 2000), candidate(0.08, 0.02, 400));
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
    fn evidence_of_a_probable_part_of_a_larger_cluster_is_contrary() {
        let pot = candidate(0.0, 0.05, 2000);
        let evidence = |x: f64, support: Option<Support>, mean_rgb: [f32; 3]| {
            let tip = Candidate {
                support,
                mean_rgb,
                ..candidate(x, 0.01, 150)
            };
            sighting_evidence(&tip, &[pot.clone(), tip.clone()])
        };
        let (hidden, grey, red) = (Some(Support::Occluded), [130.0; 3], [200.0, 40.0, 40.0]);
        assert_eq!(evidence(0.08, None, grey), Contrary);
        assert_eq!(evidence(0.12, hidden, grey), Contrary);
        // Another colour, a foot of its own, or too far away.
        assert_eq!(evidence(0.12, hidden, red), Separate);
        assert_eq!(evidence(0.12, Some(Support::Table), grey), Separate);
        assert_eq!(evidence(0.12, None, grey), Separate);
        assert_eq!(evidence(0.14, hidden, grey), Separate);
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
