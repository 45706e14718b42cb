//! Text files of a sequence: intrinsics, gravity and poses as matrices.

use super::{PinholeCamera, RigidTransform, UnitVector3, Vector3};
use crate::ContentError;
use nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion};

/// Tolerance of orthonormal columns and of unit vectors, for numbers with few digits. Chosen.
const TOLERANCE: f64 = 0.01;

/// Maximum distance of a camera from the world's origin, metres.
const MAX_DISTANCE_M: f64 = 1e6;

/// Parses a 3 x 3 intrinsic matrix `fx 0 cx; 0 fy cy; 0 0 1`, pixels, for images of a given
/// size.
///
/// # Errors
/// When the text is not such a matrix or no camera has it.
pub fn parse_intrinsics(bytes: &[u8], size: (u32, u32)) -> Result<PinholeCamera, ContentError> {
    let [fx_px, skew, cx_px, row_1, fy_px, cy_px, row_2 @ ..] = numbers::<9>(bytes)?;
    if skew != 0.0 || row_1 != 0.0 || row_2 != [0.0, 0.0, 1.0] {
        return Err(ContentError::InvalidValue(
            "the matrix must have the form fx 0 cx 0 fy cy 0 0 1",
        ));
    }
    PinholeCamera::with_intrinsics([fx_px, fy_px, cx_px, cy_px], size.into())
        .map_err(ContentError::Intrinsics)
}

/// Parses a gravity direction; returns it with unit length.
///
/// # Errors
/// When the text is not three numbers of a vector of about unit length.
pub fn parse_gravity(bytes: &[u8]) -> Result<UnitVector3<f64>, ContentError> {
    let direction = Vector3::from(numbers::<3>(bytes)?);
    if (direction.norm() - 1.0).abs() > TOLERANCE {
        return Err(ContentError::InvalidValue(
            "the direction of gravity must have length 1",
        ));
    }
    Ok(UnitVector3::new_normalize(direction))
}

/// Parses a 4 x 4 pose matrix, row-major, and returns the nearest rigid transform.
///
/// # Errors
/// When the text is not a rigid transform up to rounding, or leads out of the
/// world.
pub fn parse_pose(bytes: &[u8]) -> Result<RigidTransform, ContentError> {
    let [
        xx,
        xy,
        xz,
        tx,
        yx,
        yy,
        yz,
        ty,
        zx,
        zy,
        zz,
        tz,
        last_row @ ..,
    ] = numbers::<16>(bytes)?;
    if last_row != [0.0, 0.0, 0.0, 1.0] {
        return Err(ContentError::InvalidValue(
            "the last row of the pose must be 0 0 0 1",
        ));
    }
    let translation = Vector3::new(tx, ty, tz);
    if translation.amax() > MAX_DISTANCE_M {
        return Err(ContentError::InvalidValue(
            "the pose is more than 1000 km away",
        ));
    }
    let rotation = nearest_rotation(Matrix3::new(xx, xy, xz, yx, yy, yz, zx, zy, zz)).ok_or(
        ContentError::InvalidValue("the upper left 3x3 of the pose must be a rotation"),
    )?;
    Ok(RigidTransform::from_parts(
        Translation3::from(translation),
        rotation,
    ))
}

/// Nearest rotation: orthogonal factor of the polar decomposition by Newton's iteration (Higham
/// 1986). It converges quadratically; four steps from the tolerance exceed double precision.
fn nearest_rotation(matrix: Matrix3<f64>) -> Option<UnitQuaternion<f64>> {
    let deviation = matrix.transpose() * matrix - Matrix3::identity();
    // A NaN fails this comparison.
    let is_near = deviation.amax() <= TOLERANCE;
    if !is_near || matrix.determinant() <= 0.0 {
        return None;
    }
    let mut orthogonal = matrix;
    for _ in 0..4 {
        orthogonal = (orthogonal + orthogonal.try_inverse()?.transpose()) * 0.5;
    }
    let rotation = Rotation3::from_matrix_unchecked(orthogonal);
    Some(UnitQuaternion::from_rotation_matrix(&rotation))
}

/// Parses exactly `N` finite numbers separated by white space.
fn numbers<const N: usize>(bytes: &[u8]) -> Result<[f64; N], ContentError> {
    let wrong = || ContentError::Numbers { needed: N };
    let mut words = std::str::from_utf8(bytes)
        .map_err(|_| wrong())?
        .split_ascii_whitespace();
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        let parsed = words.next().and_then(|word| word.parse().ok());
        *number = parsed
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(wrong)?;
    }
    if words.next().is_none() {
        Ok(numbers)
    } else {
        Err(wrong())
    }
}
