//! Object axes: principal or gravity-aligned.

use crate::{DescriptorFrame, ObjectPoints};
use geometry::RigidTransform;
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion, UnitVector3, Vector3};
use point_cloud::{Moments, PrincipalAxes};

/// Kind of object axes, which determines their ambiguity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AxesKind {
    /// Principal axes, largest variance first. The signs are ambiguous: there are four
    /// right-handed hypotheses.
    Principal,
    /// Gravity-aligned axes: z up, x along the larger variance of the footprint. A
    /// nearly square footprint is ambiguous by quarter turns.
    Upright,
}

/// Object axes with the centroid of the points as origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectAxes {
    /// Kind of the object axes: how they are determined.
    pub kind: AxesKind,
    /// Transform from the cloud's frame to the axes.
    pub object_from_source: DescriptorFrame,
}

/// Axes of the finite points: gravity-aligned if `up`, the direction against gravity in
/// their frame, is given, else principal.
///
/// The signs of the axes, and the order of two nearly equal horizontal sides, depend on
/// noise: compare all axis hypotheses of a descriptor.
///
/// Returns `None` for fewer than three finite points. One pass, no allocation.
pub fn object_axes(points: ObjectPoints<'_>, up: Option<&UnitVector3<f64>>) -> Option<ObjectAxes> {
    let mut moments = Moments::default();
    points.for_each(|p| {
        if p.is_finite() {
            moments.add(&p.position());
        }
    });
    let principal = moments.principal_axes()?;
    let (kind, axes) = match up {
        None => (AxesKind::Principal, principal.axes),
        Some(up) => (AxesKind::Upright, upright_axes(&principal, up)),
    };
    let rotation = Rotation3::from_matrix_unchecked(axes);
    let source_from_object = RigidTransform::from_parts(
        principal.centroid.into(),
        UnitQuaternion::from_rotation_matrix(&rotation),
    );
    Some(ObjectAxes {
        kind,
        object_from_source: DescriptorFrame::from(&source_from_object.inverse()),
    })
}

/// Axes with z up and x along the larger variance of the horizontal footprint.
fn upright_axes(principal: &PrincipalAxes, up: &UnitVector3<f64>) -> Matrix3<f64> {
    let across = Matrix3::identity() - up.into_inner() * up.transpose();
    let variances = Matrix3::from_diagonal(&principal.variances_m2);
    let covariance = principal.axes * variances * principal.axes.transpose();
    let footprint = SymmetricEigen::new(across * covariance * across);
    let largest = footprint.eigenvectors.column(footprint.eigenvalues.imax());
    // A vertical line has no footprint: any horizontal direction is valid.
    let x = (across * largest)
        .try_normalize(1e-6)
        .unwrap_or_else(|| any_direction_across(up));
    Matrix3::from_columns(&[x, up.cross(&x), up.into_inner()])
}

fn any_direction_across(up: &UnitVector3<f64>) -> Vector3<f64> {
    let mut other = Vector3::zeros();
    other[up.iamin()] = 1.0;
    up.cross(&other).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use point_cloud::Point;

    fn cloud(points: impl IntoIterator<Item = Point3<f64>>) -> Vec<Point> {
        let point = |p: Point3<f64>| Point {
            x: p.x as f32,
            y: p.y as f32,
            z: p.z as f32,
            ..Point::default()
        };
        points.into_iter().map(point).collect()
    }

    fn slab() -> Vec<Point> {
        cloud((0..400).map(|i| {
            let t = f64::from(i);
            Point3::new(0.2 * t.sin(), 0.05 * (1.7 * t).sin(), 0.1 * (2.3 * t).sin())
        }))
    }

    fn row(axes: &ObjectAxes, i: usize) -> Vector3<f64> {
        let row = axes.object_from_source.object_from_source[i];
        Vector3::new(row[0], row[1], row[2]).map(f64::from)
    }

    #[test]
    fn principal_axes_go_from_the_largest_variance_to_the_smallest() {
        let cloud = slab();
        let axes = object_axes(ObjectPoints::all(&cloud), None).unwrap();
        assert_eq!(axes.kind, AxesKind::Principal);
        assert!(row(&axes, 0).x.abs() > 0.99);
        assert!(row(&axes, 1).z.abs() > 0.99);
        assert!(row(&axes, 2).y.abs() > 0.99);
    }

    #[test]
    fn upright_axes_keep_the_up_direction() {
        let cloud = slab();
        let up = UnitVector3::new_normalize(Vector3::new(0.1, -0.1, 1.0));
        let axes = object_axes(ObjectPoints::all(&cloud), Some(&up)).unwrap();
        assert_eq!(axes.kind, AxesKind::Upright);
        assert!((row(&axes, 2) - up.into_inner()).norm() < 1e-6);
        assert!(row(&axes, 0).x.abs() > 0.98);
        let handedness = row(&axes, 0).cross(&row(&axes, 1)).dot(&row(&axes, 2));
        assert!((handedness - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_vertical_line_has_upright_axes_and_two_points_have_none() {
        let line = cloud((0..20).map(|i| Point3::new(0.0, 0.0, 0.01 * f64::from(i))));
        let up = Vector3::z_axis();
        let axes = object_axes(ObjectPoints::all(&line), Some(&up)).unwrap();
        assert!((row(&axes, 0).norm() - 1.0).abs() < 1e-6);
        assert!(object_axes(ObjectPoints::all(&line[..2]), Some(&up)).is_none());
    }
}
