//! Bounding box, area, volume and centre of mass of a mesh.

use crate::TriangleMesh;
use nalgebra::{Point3, Vector3};

/// Axis-aligned bounding box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Minimum corner of the bounding box.
    pub min: Point3<f32>,
    /// Maximum corner of the bounding box.
    pub max: Point3<f32>,
}

impl Bounds {
    /// Bounding box of the finite points; `None` without finite points.
    pub fn of(points: impl IntoIterator<Item = Point3<f32>>) -> Option<Self> {
        let finite = |point: &Point3<f32>| point.iter().all(|x| x.is_finite());
        points
            .into_iter()
            .filter(finite)
            .map(|point| Self {
                min: point,
                max: point,
            })
            .reduce(|a, b| Self {
                min: a.min.inf(&b.min),
                max: a.max.sup(&b.max),
            })
    }

    /// Centre of the bounding box.
    pub fn centre(&self) -> Point3<f32> {
        nalgebra::center(&self.min, &self.max)
    }

    /// Side lengths of the bounding box.
    pub fn sides(&self) -> Vector3<f32> {
        self.max - self.min
    }
}

impl TriangleMesh {
    /// Bounding box of the finite vertices; `None` without finite vertices.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.vertices.iter().map(|vertex| vertex.position))
    }

    /// Total area of the faces, square metres.
    pub fn surface_area(&self) -> f64 {
        self.sum(|[a, b, c]| (b - a).cross(&(c - a)).norm() / 2.0)
    }

    /// Volume enclosed by a closed mesh, cubic metres; negative when the faces are oriented
    /// inwards. Overlaps of components count twice.
    pub fn signed_volume(&self) -> f64 {
        self.sum(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
    }

    /// Centre of mass of a closed mesh of uniform density, by the divergence
    /// theorem; `None` for a mesh without volume.
    pub fn centre_of_mass(&self) -> Option<Point3<f32>> {
        let volume = self.signed_volume();
        let moment = |axis: usize| {
            self.sum(|[a, b, c]| a.dot(&b.cross(&c)) * (a[axis] + b[axis] + c[axis]) / 24.0)
        };
        let at = [moment(0), moment(1), moment(2)].map(|moment| (moment / volume) as f32);
        at.iter()
            .all(|x| x.is_finite())
            .then(|| self.origin() + Vector3::from(at))
    }

    /// Reference point of the sums near the mesh, to avoid cancellation far from the origin.
    fn origin(&self) -> Point3<f32> {
        self.bounds()
            .map_or_else(Point3::origin, |bounds| bounds.min)
    }

    /// Sum over the triangles with finite corners.
    fn sum(&self, of: impl Fn([Vector3<f64>; 3]) -> f64) -> f64 {
        let origin = self.origin();
        let local = |point: Point3<f32>| (point - origin).cast::<f64>();
        (0..self.triangles.len())
            .filter_map(|i| self.corners(i))
            .map(|corners| of(corners.map(local)))
            .filter(|term| term.is_finite())
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use crate::{TriangleMesh, ellipsoid, lathe, rounded_box};
    use nalgebra::{Isometry3, Point2, Vector3};
    use std::f64::consts::PI;

    #[test]
    fn a_box_has_the_area_and_volume_of_a_box() {
        let mesh = rounded_box([0.1, 0.2, 0.3], 0.0, 1.0).mesh;
        assert!((mesh.signed_volume() - 0.006).abs() < 1e-8);
        assert!((mesh.surface_area() - 0.22).abs() < 1e-7);
    }

    #[test]
    fn an_ellipsoid_approaches_the_formula() {
        let mesh = ellipsoid([0.03, 0.04, 0.05], 96).mesh;
        let expected = 4.0 / 3.0 * PI * 0.03 * 0.04 * 0.05;
        assert!((mesh.signed_volume() / expected - 1.0).abs() < 0.005);
    }

    #[test]
    fn a_cone_is_heavy_at_a_quarter_of_its_height() {
        let mut mesh = lathe(
            &[
                Point2::new(0.0, 0.0),
                Point2::new(0.05, 0.0),
                Point2::new(0.0, 0.2),
            ],
            48,
        )
        .mesh;
        mesh.transform(&Isometry3::translation(3.0, -1.0, 2.0));
        let centre = mesh.centre_of_mass().unwrap();
        assert!((centre.coords - Vector3::new(3.0, -1.0, 2.05)).norm() < 1e-4);
    }

    #[test]
    fn an_empty_mesh_has_no_measures() {
        let mesh = TriangleMesh::default();
        assert!(mesh.bounds().is_none() && mesh.centre_of_mass().is_none());
        assert_eq!(mesh.surface_area(), 0.0);
    }
}
