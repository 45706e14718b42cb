//! Oriented plane.

use nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};

/// Oriented plane: all points p with `normal · p + offset_m = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Unit normal, on the side of positive heights.
    pub normal: Unit<Vector3<f64>>,
    /// Signed distance of the origin from the plane, metres.
    pub offset_m: f64,
}

impl Plane {
    /// Plane through a point with a normal.
    pub fn through(point: &Point3<f64>, normal: Unit<Vector3<f64>>) -> Self {
        Self {
            normal,
            offset_m: -normal.dot(&point.coords),
        }
    }

    /// Plane through three points; `None` when they are nearly collinear (the doubled area of the
    /// triangle is below 1e-9 m²).
    pub fn through_points(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>) -> Option<Self> {
        let normal = Unit::try_new((b - a).cross(&(c - a)), 1e-9)?;
        Some(Self::through(a, normal))
    }

    /// Signed height of a point above the plane, metres.
    #[inline]
    pub fn height_m(&self, point: &Point3<f64>) -> f64 {
        self.normal.dot(&point.coords) + self.offset_m
    }

    /// Plane with its normal flipped, if needed, so that `point` has a positive height.
    pub fn facing(self, point: &Point3<f64>) -> Self {
        if self.height_m(point) < 0.0 {
            Self {
                normal: -self.normal,
                offset_m: -self.offset_m,
            }
        } else {
            self
        }
    }

    /// Transform into a plane frame: z along the normal, origin at the foot point of the source
    /// frame's origin, x along the projection of the source axis least parallel to the normal.
    pub fn plane_from_source(&self) -> Isometry3<f64> {
        let n = self.normal.into_inner();
        let helper = Vector3::ith(n.iamin(), 1.0);
        let x = (helper - n * n.dot(&helper)).normalize();
        let basis = nalgebra::Matrix3::from_columns(&[x, n.cross(&x), n]);
        let source_from_plane = UnitQuaternion::from_matrix(&basis);
        let origin_in_source = -n * self.offset_m;
        Isometry3::from_parts(origin_in_source.into(), source_from_plane).inverse()
    }

    /// Plane transformed into another frame.
    pub fn transformed(&self, target_from_source: &Isometry3<f64>) -> Self {
        let foot = target_from_source * Point3::from(-self.normal.into_inner() * self.offset_m);
        Self::through(&foot, target_from_source.rotation * self.normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slanted() -> Plane {
        Plane::through_points(
            &Point3::new(0.0, 0.3, 1.0),
            &Point3::new(1.0, 0.35, 1.2),
            &Point3::new(0.2, 0.1, 1.9),
        )
        .unwrap()
    }

    #[test]
    fn heights_are_measured_in_the_planes_own_frame() {
        let plane = slanted();
        let plane_from_source = plane.plane_from_source();
        for p in [Point3::new(0.1, 0.2, 0.3), Point3::new(-1.0, 2.0, 0.5)] {
            assert!((plane.height_m(&p) - (plane_from_source * p).z).abs() < 1e-12);
        }
    }

    #[test]
    fn heights_survive_a_change_of_frame() {
        let target_from_source =
            Isometry3::new(Vector3::new(0.4, -1.0, 2.0), Vector3::new(0.3, 1.1, -0.2));
        let p = Point3::new(0.3, -0.4, 1.5);
        let before = slanted().height_m(&p);
        let after = slanted()
            .transformed(&target_from_source)
            .height_m(&(target_from_source * p));
        assert!((before - after).abs() < 1e-12);
    }

    #[test]
    fn three_points_on_a_line_span_no_plane() {
        let at = |t: f64| Point3::new(t, 2.0 * t, 1.0 - t);
        assert_eq!(Plane::through_points(&at(0.0), &at(0.4), &at(2.0)), None);
    }

    #[test]
    fn a_plane_turns_its_positive_side_to_the_viewer() {
        let viewer = Point3::origin();
        assert!(slanted().facing(&viewer).height_m(&viewer) > 0.0);
    }
}
