//! Orientation of a measured box: symmetry resolution and rotation noise.

use geometry::OrientedBox;
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Ratio of sides at which a quarter turn costs as much as a rotation by 45 degrees.
/// Chosen.
const QUARTER_TURN_SIDE_RATIO: f64 = 1.65;

/// Yaw noise of an elongated object with all its variance along one axis, radians (5
/// degrees). Chosen.
const AXIS_SIGMA_RAD: f64 = 0.087;

/// Lower limit of the rotation noise, radians (1.5 degrees). Chosen.
const SIGMA_MIN_RAD: f64 = 0.026;

/// Upper limit of the rotation noise of round objects, radians (20 degrees). Chosen.
const SIGMA_MAX_RAD: f64 = 0.35;

/// Saturation of the side mismatch in the symmetry cost. Chosen.
const SIDE_MISMATCH_MAX: f64 = 2.0;

/// Symmetry-equivalent box nearest to the expected one. A box is unchanged by half a
/// turn about its upright axis, and by a quarter turn with its sides exchanged; choosing
/// the nearest equivalent keeps the pose from flipping.
pub(crate) fn nearest_equivalent_box(
    measured: &OrientedBox,
    expected: &OrientedBox,
) -> OrientedBox {
    let equivalent = |quarter: u8| quarter_turned(measured, quarter);
    let cost = |equivalent: &OrientedBox| {
        let angle = rotation(expected).angle_to(&rotation(equivalent));
        let mismatch = side_mismatch(&equivalent.half_sides_m, &expected.half_sides_m);
        angle / FRAC_PI_4 + mismatch.min(SIDE_MISMATCH_MAX)
    };
    let mut best = equivalent(0);
    for quarter in 1..4 {
        let other = equivalent(quarter);
        if cost(&other) < cost(&best) {
            best = other;
        }
    }
    best
}

fn rotation(shape: &OrientedBox) -> UnitQuaternion<f64> {
    shape.frame_from_box.rotation
}

/// Equivalent box after a number of quarter turns about the upright axis.
fn quarter_turned(shape: &OrientedBox, quarter: u8) -> OrientedBox {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2 * f64::from(quarter));
    let half = shape.half_sides_m;
    OrientedBox {
        frame_from_box: shape.frame_from_box * turn,
        half_sides_m: if quarter % 2 == 1 {
            Vector3::new(half.y, half.x, half.z)
        } else {
            half
        },
    }
}

/// Mismatch of the horizontal sides, in logarithms to the base
/// [`QUARTER_TURN_SIDE_RATIO`].
fn side_mismatch(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let ratio = |i: usize| ((a[i] + 1e-3) / (b[i] + 1e-3)).ln().abs();
    (ratio(0) + ratio(1)) / QUARTER_TURN_SIDE_RATIO.ln()
}

/// Standard deviation of the measured rotation about each axis of the box, radians, from
/// the variances of its points along them.
///
/// The two horizontal axes are separated by the gap of their variances: the yaw noise is
/// 5° times the larger variance over their difference (perturbation of eigenvectors,
/// Davis and Kahan 1970), within limits. The upright axis comes from the table, which
/// fixes the other two rotations.
pub(crate) fn rotation_sigmas_rad(variances_m2: &Vector3<f64>) -> Vector3<f64> {
    let [x, y] = [variances_m2.x, variances_m2.y];
    let sigma = AXIS_SIGMA_RAD * x.max(y) / (x - y).abs();
    let about_upright = if sigma.is_finite() {
        sigma.clamp(SIGMA_MIN_RAD, SIGMA_MAX_RAD)
    } else {
        SIGMA_MAX_RAD
    };
    Vector3::new(SIGMA_MIN_RAD, SIGMA_MIN_RAD, about_upright)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::RigidTransform;
    use proptest::prelude::*;

    fn upright(yaw_rad: f64, half: [f64; 3]) -> OrientedBox {
        OrientedBox {
            frame_from_box: RigidTransform::new(Vector3::zeros(), Vector3::z() * yaw_rad),
            half_sides_m: half.into(),
        }
    }

    proptest! {
        #[test]
        fn equivalent_boxes_cover_the_same_volume(
            yaw in -3.0..3.0_f64, tilt in -0.3..0.3_f64, quarter in 0..4_u8, x in -1.0..1.0_f64, z in -1.0..1.0_f64,
        ) {
            let mut shape = upright(yaw, [0.1, 0.04, 0.2]);
            shape.frame_from_box.rotation *= UnitQuaternion::from_scaled_axis(Vector3::x() * tilt);
            let equivalent = quarter_turned(&shape, quarter);
            let corner = shape.half_sides_m.component_mul(&Vector3::new(x.signum(), 1.0, z.signum()));
            let point = shape.frame_from_box * nalgebra::Point3::from(corner * 0.999);
            prop_assert!(equivalent.contains(&point, 0.0));
            let again = nearest_equivalent_box(&equivalent, &shape);
            prop_assert!(rotation(&again).angle_to(&rotation(&shape)) < 1e-6);
            prop_assert!((again.half_sides_m - shape.half_sides_m).norm() < 1e-12);
        }
    }

    #[test]
    fn rotation_noise_is_large_for_round_and_small_for_long_objects() {
        let sigma = |x: f64, y: f64| rotation_sigmas_rad(&Vector3::new(x, y, 1e-3)).z;
        assert_eq!(sigma(1e-3, 1e-3), SIGMA_MAX_RAD);
        assert_eq!(sigma(0.0, 0.0), SIGMA_MAX_RAD);
        assert_eq!(sigma(f64::NAN, 1e-3), SIGMA_MAX_RAD);
        assert!((sigma(1e-3, 1e-5) - AXIS_SIGMA_RAD).abs() < 2e-3);
        assert!((sigma(1e-5, 1e-3) - AXIS_SIGMA_RAD).abs() < 2e-3);
        assert!(sigma(1e-3, 5e-4) > 1.9 * AXIS_SIGMA_RAD);
    }
}
