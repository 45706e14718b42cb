//! The object's own frame with signs that stay when the object or camera moves.

use crate::{DescriptorFrame, ObjectPoints};
use geometry::RigidTransform;
use nalgebra::{Matrix3, Point3, Rotation3, UnitQuaternion, Vector3};
use point_cloud::{Moments, PrincipalAxes};

/// Below this cosine of the angle between an axis and the direction to the
/// viewer, noise decides on which side of the axis the viewer is.
const MIN_VIEW_COSINE: f64 = 0.1;

/// Below this standardised third moment, noise decides which tail is longer.
const MIN_SKEWNESS: f64 = 0.1;

/// A right-handed frame in the middle of the visible points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectFrame {
    /// Origin at the centroid; x along the largest variance, z along the smallest.
    pub source_from_object: RigidTransform,
    /// Variances along x, y and z, square metres. Where two are nearly equal, as on
    /// round objects, the two axes may turn freely.
    pub variances_m2: Vector3<f64>,
}

impl ObjectFrame {
    /// The frame for a descriptor.
    pub fn descriptor_frame(&self) -> DescriptorFrame {
        DescriptorFrame::from(&self.source_from_object.inverse())
    }
}

/// Principal axes of the finite points with stable signs; `viewpoint` is the
/// sensor's place in the frame of the points.
///
/// The z axis points to the viewer. When the viewer sees the object along the
/// edge (cosine below 0.1), the longer tail along z decides.
///
/// The x axis points to its longer tail: its third moment is positive. When the
/// standardised third moment is below 0.1 the next of these decides, each with
/// its own dead band: the third moment of y, x to the viewer, y to the viewer.
/// An object without any of these looks the same from both sides; then x has a
/// positive largest component in the frame of the points, which is the only
/// choice that depends on that frame.
///
/// The frame follows every rigid motion of points and viewpoint together, and
/// does not depend on the order of points (up to rounding).
///
/// `None` for fewer than three finite points. Two passes, no allocation.
pub fn object_frame(points: ObjectPoints<'_>, viewpoint: &Point3<f64>) -> Option<ObjectFrame> {
    let mut moments = Moments::default();
    points.for_each(|p| {
        if p.is_finite() {
            moments.add(&p.position());
        }
    });
    let principal = moments.principal_axes()?;
    let axes = with_stable_signs(&principal, &skewness(points, &principal), viewpoint);
    let rotation = Rotation3::from_matrix_unchecked(axes);
    Some(ObjectFrame {
        source_from_object: RigidTransform::from_parts(
            principal.centroid.into(),
            UnitQuaternion::from_rotation_matrix(&rotation),
        ),
        variances_m2: principal.variances_m2,
    })
}

/// Standardised third moments along the axes; zero along an axis without extent.
fn skewness(points: ObjectPoints<'_>, principal: &PrincipalAxes) -> Vector3<f64> {
    let object_from_source = principal.axes.transpose();
    let mut cubes = Vector3::<f64>::zeros();
    let mut n = 0_usize;
    points.for_each(|p| {
        if p.is_finite() {
            let q = object_from_source * (p.position() - principal.centroid);
            cubes += q.component_mul(&q).component_mul(&q);
            n += 1;
        }
    });
    cubes.zip_map(&principal.variances_m2, |cube, variance| {
        let skewness = cube / (n as f64 * variance * variance.sqrt());
        if skewness.is_finite() { skewness } else { 0.0 }
    })
}

fn with_stable_signs(
    principal: &PrincipalAxes,
    skewness: &Vector3<f64>,
    viewpoint: &Point3<f64>,
) -> Matrix3<f64> {
    let axes = &principal.axes;
    let to_viewer = (viewpoint - principal.centroid)
        .try_normalize(0.0)
        .unwrap_or_default();
    let view_cosine = axes.transpose() * to_viewer;
    let z_sign = first_decided(&[
        (view_cosine.z, MIN_VIEW_COSINE),
        (skewness.z, MIN_SKEWNESS),
        (view_cosine.z, 0.0),
    ]);
    // y follows from x and z, so what is known of y is seen for x = +x.
    let x = axes.column(0);
    let x_sign = first_decided(&[
        (skewness.x, MIN_SKEWNESS),
        (z_sign * skewness.y, MIN_SKEWNESS),
        (view_cosine.x, MIN_VIEW_COSINE),
        (z_sign * view_cosine.y, MIN_VIEW_COSINE),
        (x[x.iamax()], 0.0),
    ]);
    let (x, z) = (x * x_sign, axes.column(2) * z_sign);
    Matrix3::from_columns(&[x, z.cross(&x), z])
}

/// Sign of the first cue that exceeds its dead band; +1 when none does.
fn first_decided(cues: &[(f64, f64)]) -> f64 {
    cues.iter()
        .find(|(cue, dead_band)| cue.abs() > *dead_band)
        .map_or(1.0, |(cue, _)| cue.signum())
}

#[cfg(test)]
mod tests;
