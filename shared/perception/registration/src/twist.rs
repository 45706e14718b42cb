//! Twists: small rigid motions, with their uncertainty about one point and another.

use nalgebra::{Isometry3, Matrix6, Point3, Translation3, UnitQuaternion, Vector3, Vector6};

/// Small rigid motion: a rotation vector, radians, then the shift of a reference point, metres.
pub type Twist = Vector6<f64>;

/// Motion of a twist about a point.
pub fn motion_about(twist: &Twist, point: &Point3<f64>) -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_scaled_axis(twist.fixed_rows::<3>(0).into_owned());
    let translation: Vector3<f64> = twist.fixed_rows::<3>(3).into();
    let shift = point.coords + translation - rotation * point.coords;
    Isometry3::from_parts(Translation3::from(shift), rotation)
}

/// Motion of a twist about the origin.
pub fn exponential(twist: &Twist) -> Isometry3<f64> {
    motion_about(twist, &Point3::origin())
}

/// Twist of a motion about a point.
pub fn twist_at(motion: &Isometry3<f64>, point: &Point3<f64>) -> Twist {
    let mut twist = Twist::zeros();
    twist
        .fixed_rows_mut::<3>(0)
        .copy_from(&motion.rotation.scaled_axis());
    twist
        .fixed_rows_mut::<3>(3)
        .copy_from(&(motion * point - point));
    twist
}

/// Matrix that leads from a twist about the origin to the same motion about a point.
pub fn moved_to(point: &Point3<f64>) -> Matrix6<f64> {
    let mut matrix = Matrix6::identity();
    matrix
        .fixed_view_mut::<3, 3>(3, 0)
        .copy_from(&-point.coords.cross_matrix());
    matrix
}

/// Covariance of a twist with the same standard deviation in each direction.
pub fn isotropic(rotation_sigma_rad: f64, translation_sigma_m: f64) -> Matrix6<f64> {
    let (rotation, translation) = (rotation_sigma_rad.powi(2), translation_sigma_m.powi(2));
    Matrix6::from_diagonal(&Vector6::from_fn(|i, _| {
        if i < 3 { rotation } else { translation }
    }))
}
