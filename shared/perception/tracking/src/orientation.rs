//! How a measured box is turned: its readings, and how sure it is.

use geometry::OrientedBox;
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Sides may differ by this factor before a quarter turn explains them better
/// than a turn by 45 degrees.
const SIDE_RATIO_TURN: f64 = 1.65;

/// Noise of the direction of a long object's axis, radians (5 degrees, of one with
/// all its variance along that axis).
const AXIS_SIGMA_RAD: f64 = 0.087;

/// However clear the axes, the box is not turned more exactly, radians (1.5 degrees).
const SIGMA_MIN_RAD: f64 = 0.026;

/// However round the object, its box is not turned more wrongly, radians (20 degrees).
const SIGMA_MAX_RAD: f64 = 0.35;

/// The sides of a reading differ from the expected ones by a factor of e at most
/// this often before they count no more.
const MISMATCH_MAX: f64 = 2.0;

/// A box reads the same after a half turn about its upright axis, and with its
/// sides exchanged after a quarter turn: the reading nearest to what is expected,
/// so that the pose does not flip.
pub(crate) fn nearest_reading(measured: &OrientedBox, expected: &OrientedBox) -> OrientedBox {
    let reading = |quarter: u8| turned(measured, quarter);
    let cost = |reading: &OrientedBox| {
        let angle = rotation(expected).angle_to(&rotation(reading));
        let mismatch = side_mismatch(&reading.half_sides_m, &expected.half_sides_m);
        angle / FRAC_PI_4 + mismatch.min(MISMATCH_MAX)
    };
    let mut best = reading(0);
    for quarter in 1..4 {
        let other = reading(quarter);
        if cost(&other) < cost(&best) {
            best = other;
        }
    }
    best
}

fn rotation(shape: &OrientedBox) -> UnitQuaternion<f64> {
    shape.frame_from_box.rotation
}

/// The same box, its axes named anew after quarter turns about the upright one.
fn turned(shape: &OrientedBox, quarter: u8) -> OrientedBox {
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

/// How badly horizontal sides fit; 1 for a factor of [`SIDE_RATIO_TURN`].
fn side_mismatch(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let ratio = |i: usize| ((a[i] + 1e-3) / (b[i] + 1e-3)).ln().abs();
    (ratio(0) + ratio(1)) / SIDE_RATIO_TURN.ln()
}

/// Standard deviation of the measured turn about each axis of the box, radians,
/// from the variances of its points along them.
///
/// Two axes are told apart by the gap of their variances: the noise of the turn
/// between them is 5° times the larger variance over their difference (perturbation
/// of eigenvectors, Davis and Kahan 1970), within limits. The upright axis comes from the table,
/// which fixes the other two turns.
pub(crate) fn turn_sigmas_rad(variances_m2: &Vector3<f64>) -> Vector3<f64> {
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
        fn all_readings_of_a_box_are_the_same_box(
            yaw in -3.0..3.0_f64, tilt in -0.3..0.3_f64, quarter in 0..4_u8, x in -1.0..1.0_f64, z in -1.0..1.0_f64,
        ) {
            let mut shape = upright(yaw, [0.1, 0.04, 0.2]);
            shape.frame_from_box.rotation *= UnitQuaternion::from_scaled_axis(Vector3::x() * tilt);
            let reading = turned(&shape, quarter);
            let corner = shape.half_sides_m.component_mul(&Vector3::new(x.signum(), 1.0, z.signum()));
            let point = shape.frame_from_box * nalgebra::Point3::from(corner * 0.999);
            prop_assert!(reading.contains(&point, 0.0));
            let again = nearest_reading(&reading, &shape);
            prop_assert!(rotation(&again).angle_to(&rotation(&shape)) < 1e-6);
            prop_assert!((again.half_sides_m - shape.half_sides_m).norm() < 1e-12);
        }
    }

    #[test]
    fn round_things_may_be_turned_anyhow_and_long_ones_not() {
        let sigma = |x: f64, y: f64| turn_sigmas_rad(&Vector3::new(x, y, 1e-3)).z;
        assert_eq!(sigma(1e-3, 1e-3), SIGMA_MAX_RAD);
        assert_eq!(sigma(0.0, 0.0), SIGMA_MAX_RAD);
        assert_eq!(sigma(f64::NAN, 1e-3), SIGMA_MAX_RAD);
        assert!((sigma(1e-3, 1e-5) - AXIS_SIGMA_RAD).abs() < 2e-3);
        assert!((sigma(1e-5, 1e-3) - AXIS_SIGMA_RAD).abs() < 2e-3);
        assert!(sigma(1e-3, 5e-4) > 1.9 * AXIS_SIGMA_RAD);
    }
}
