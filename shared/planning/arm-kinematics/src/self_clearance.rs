//! Self-collision distance of the arm.

use geometry::Capsule;
use nalgebra::Vector3;

use crate::N_CAPSULES;

/// Self-collision pairs, by their indices in [`link_capsules()`](crate::link_capsules()): hand and wrist (6 to 12)
/// with base, turret, shoulder and upper arm (0 to 3), forearm (5) with base to shoulder, hand (9
/// to 12) with elbow and forearm. Neighbouring links overlap by design and are skipped.
fn may_collide(near: usize, far: usize) -> bool {
    match near {
        0..=2 => far >= 5,
        3 => far >= 6,
        4 | 5 => far >= 9,
        _ => false,
    }
}

/// Least distance between links that are not neighbours, metres; negative when they overlap.
/// Takes the result of [`link_capsules()`](crate::link_capsules()).
pub fn self_clearance_m(capsules: &[Capsule; N_CAPSULES]) -> f64 {
    let mut least = f64::INFINITY;
    for near in 0..N_CAPSULES {
        for far in (near + 1..N_CAPSULES).filter(|&far| may_collide(near, far)) {
            least = least.min(capsule_distance_m(&capsules[near], &capsules[far]));
        }
    }
    least
}

/// Distance between the surfaces of two capsules, metres; negative when they overlap.
fn capsule_distance_m(a: &Capsule, b: &Capsule) -> f64 {
    segment_distance_m(a, b) - a.radius_m - b.radius_m
}

/// Distance between two segments, metres (Ericson 2005, 5.1.9): the nearest points of the lines,
/// clamped to the segments one after the other.
fn segment_distance_m(a: &Capsule, b: &Capsule) -> f64 {
    let (along_a, along_b) = (a.to - a.from, b.to - b.from);
    let between = a.from - b.from;
    let (aa, bb, ab) = (
        along_a.norm_squared(),
        along_b.norm_squared(),
        along_a.dot(&along_b),
    );
    let (ra, rb) = (along_a.dot(&between), along_b.dot(&between));
    // Zero for parallel segments: any point of the first one will do.
    let spread = aa * bb - ab * ab;
    let mut s = clamped_ratio(ab * rb - ra * bb, spread);
    let t = clamped_ratio(ab * s + rb, bb);
    s = clamped_ratio(ab * t - ra, aa);
    let gap: Vector3<f64> = between + along_a * s - along_b * t;
    gap.norm()
}

/// Quotient clamped to 0 to 1; 0 when the denominator is not positive.
fn clamped_ratio(numerator: f64, denominator: f64) -> f64 {
    if denominator > 0.0 {
        (numerator / denominator).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Arm, HOME, JointVector, link_capsules};
    use nalgebra::Point3;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point3<f64>> {
        proptest::array::uniform3(-1.0..1.0_f64).prop_map(Point3::from)
    }

    proptest! {
        #[test]
        fn the_distance_of_segments_is_the_least_over_their_points(
            from_a in point(), to_a in point(), from_b in point(), to_b in point(),
            radius_m in 0.0..0.2_f64,
        ) {
            let a = Capsule { from: from_a, to: to_a, radius_m };
            let b = Capsule { from: from_b, to: to_b, radius_m };
            let brute = (0..=2000)
                .map(|k| a.from + (a.to - a.from) * (f64::from(k) / 2000.0))
                .map(|p| b.distance_m(&p) - a.radius_m)
                .fold(f64::INFINITY, f64::min);
            let found = capsule_distance_m(&a, &b);
            prop_assert!(found <= brute + 1e-12 && found >= brute - 1e-3, "{found} {brute}");
        }
    }

    #[test]
    fn at_home_the_arm_keeps_away_from_itself_and_a_folded_hand_does_not() {
        let arm = Arm::jaco_like();
        let clearance = |angles| self_clearance_m(&link_capsules(&arm, &angles, 0.15));
        assert!(clearance(JointVector::from(HOME)) > 0.02);
        assert!(clearance(JointVector::zeros()) > 0.05);
        let folded = JointVector::from([0.0, 0.0, 2.8, 0.0, 0.2, 0.0]);
        assert!(clearance(folded) < 0.0);
        // The wrist against the upper arm alone: the hand points away.
        let pressed = JointVector::from([0.0, 0.0, 2.8, 0.0, -1.0, 0.0]);
        assert!(clearance(pressed) < 0.02);
    }
}
