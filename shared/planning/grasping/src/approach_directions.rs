//! Approach directions of a pair of contacts, and tool poses at it.

use crate::antipodal_pairs::AntipodalPair;
use geometry::RigidTransform;
use nalgebra::{Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Turns of the approach about the closing direction, from straight down, degrees.
const TURNS_DEG: [f64; 7] = [0.0, 30.0, -30.0, 60.0, -60.0, 90.0, -90.0];
/// Vertical part of a closing direction from which on the approach is level.
const UPRIGHT: f64 = 0.8;
/// Vertical part of a closing direction up to which it is levelled, and up to which the tilted one is
/// left out: sines of 25° and 10°.
const LEVELLED_MAX: f64 = 0.42;
const LEVELLED_ALONE: f64 = 0.17;

/// Directions of approach at right angles to a closing direction, from above to level.
pub(crate) fn approaches(closing: &Vector3<f64>) -> Vec<Vector3<f64>> {
    if closing.z.abs() > UPRIGHT {
        let level = (0..8).filter_map(|k| {
            let (sine, cosine) = (f64::from(k) * PI / 4.0).sin_cos();
            let level = Vector3::new(cosine, sine, 0.0);
            (level - closing * closing.dot(&level)).try_normalize(1e-6)
        });
        return level.collect();
    }
    let down = -Vector3::z();
    let steepest = (down - closing * closing.dot(&down)).normalize();
    let about = Unit::new_normalize(*closing);
    TURNS_DEG
        .iter()
        .map(|turn_deg| Rotation3::from_axis_angle(&about, turn_deg.to_radians()) * steepest)
        .filter(|approach| approach.z < 0.1)
        .collect()
}

/// Pair with a level closing direction, so that both fingers come as near to the surface as they
/// can; one that is clearly tilted stays beside it as it is.
pub(crate) fn levelled(pair: &AntipodalPair) -> Vec<AntipodalPair> {
    let tilt = pair.closing.z.abs();
    let level = Vector3::new(pair.closing.x, pair.closing.y, 0.0);
    if tilt > LEVELLED_MAX {
        return vec![*pair];
    }
    let closing = level.normalize();
    let level = AntipodalPair { closing, ..*pair };
    if tilt > LEVELLED_ALONE {
        vec![level, *pair]
    } else {
        vec![level]
    }
}

/// Tool pose with its origin in the middle of a pair, x along the closing direction and z along the
/// approach.
pub(crate) fn tool_pose(pair: &AntipodalPair, approach: &Vector3<f64>) -> RigidTransform {
    let axes = [pair.closing, approach.cross(&pair.closing), *approach];
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&axes));
    RigidTransform::from_parts(
        Translation3::from(pair.middle.coords),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}
