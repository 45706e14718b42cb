//! Solid: visual mesh with convex collision parts.

use crate::surface_builder::{CREASE_RAD, orient_outwards};
use crate::{ConvexPart, Surface, TriangleMesh};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use std::ops::Range;

/// Solid: visual mesh and collision shapes of a body. Builders create solids; the methods
/// paint, move and merge them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Solid {
    /// Visual mesh: closed surface, oriented outwards.
    pub mesh: TriangleMesh,
    /// Collision shapes: convex parts that fill the mesh to within a few millimetres.
    pub convex_parts: Vec<ConvexPart>,
    /// Triangle ranges of the mesh without collision shape (decoration).
    pub decoration: Vec<Range<usize>>,
}

impl Solid {
    /// Solid with a colour for each vertex, by position and normal in the solid's current frame.
    pub fn painted(mut self, color: impl Fn(&Point3<f32>, &Vector3<f32>) -> [u8; 3]) -> Self {
        self.mesh.paint(color);
        self
    }

    /// Solid painted in one colour.
    pub fn colored(self, color: [u8; 3]) -> Self {
        self.painted(|_, _| color)
    }

    /// Solid with one surface for all faces.
    pub fn with_surface(mut self, surface: Surface) -> Self {
        self.mesh.set_surface(surface);
        self
    }

    /// Solid translated by a displacement (x, y, z), metres.
    pub fn moved(self, x: f32, y: f32, z: f32) -> Self {
        self.transformed(&Isometry3::translation(x, y, z))
    }

    /// Solid rotated about an axis through the origin, right-handed.
    pub fn rotated(self, axis: Vector3<f32>, angle_rad: f32) -> Self {
        let axis = nalgebra::Unit::new_normalize(axis);
        let rotation = UnitQuaternion::from_axis_angle(&axis, angle_rad);
        self.transformed(&Isometry3::from_parts(
            nalgebra::Translation3::identity(),
            rotation,
        ))
    }

    /// Solid transformed by `pose`, which is `target_from_source`.
    pub fn transformed(mut self, pose: &Isometry3<f32>) -> Self {
        self.mesh.transform(pose);
        for part in &mut self.convex_parts {
            part.transform(pose);
        }
        self
    }

    /// Solid deformed by a continuous map of space, with new normals.
    pub fn warped(mut self, map: impl Fn(Point3<f32>) -> Point3<f32>) -> Self {
        for vertex in &mut self.mesh.vertices {
            vertex.position = map(vertex.position);
        }
        orient_outwards(&mut self.mesh);
        self.mesh.smooth_normals(CREASE_RAD);
        for point in self.convex_parts.iter_mut().flat_map(|p| &mut p.points) {
            *point = map(*point);
        }
        self
    }

    /// Solid scaled along the axes by factors other than zero.
    pub fn stretched(self, x: f32, y: f32, z: f32) -> Self {
        self.warped(|p| Point3::new(p.x * x, p.y * y, p.z * z))
    }

    /// Union with another solid; overlaps are kept.
    pub fn joined(mut self, other: Self) -> Self {
        let first = self.mesh.triangles.len();
        let decoration = other.decoration.into_iter();
        self.decoration
            .extend(decoration.map(|range| range.start + first..range.end + first));
        self.mesh.append(&other.mesh);
        self.convex_parts.extend(other.convex_parts);
        self
    }

    /// Solid with its convex hull as the only collision shape, for nearly convex or very fine
    /// bodies.
    pub fn with_convex_hull(mut self) -> Self {
        let points = self.mesh.vertices.iter().map(|v| v.position).collect();
        self.convex_parts = vec![ConvexPart::around(points)];
        self.decoration.clear();
        self
    }

    /// Solid without collision shapes, for decoration.
    pub fn decorative(mut self) -> Self {
        self.convex_parts.clear();
        self.decoration = std::iter::once(0..self.mesh.triangles.len()).collect();
        self
    }

    /// Solid with the centre of its bounding box at the origin.
    pub fn recentred(mut self) -> Self {
        let shift = self.mesh.recentre();
        for point in self.convex_parts.iter_mut().flat_map(|p| &mut p.points) {
            *point += shift;
        }
        self
    }
}

impl FromIterator<Solid> for Solid {
    fn from_iter<I: IntoIterator<Item = Solid>>(solids: I) -> Self {
        solids.into_iter().fold(Solid::default(), Solid::joined)
    }
}

#[cfg(test)]
mod tests {
    use crate::{ellipsoid, rounded_box};
    use nalgebra::Point3;

    #[test]
    fn decoration_is_known_after_joining_and_deforming() {
        let body = rounded_box([0.1, 0.1, 0.1], 0.0, 0.05);
        let detail = ellipsoid([0.01, 0.01, 0.01], 12).moved(0.0, 0.0, 1.0);
        let n = body.mesh.triangles.len();
        let solid = body
            .clone()
            .joined(detail.decorative())
            .joined(body)
            .warped(|p| Point3::new(p.x, p.y, p.z + 0.1 * p.x));
        let [range] = solid.decoration.as_slice() else {
            panic!("{:?}", solid.decoration);
        };
        for (i, triangle) in solid.mesh.triangles.iter().enumerate() {
            let corner = solid.mesh.vertices[triangle.vertices[0] as usize].position;
            assert_eq!(corner.z > 0.5, range.contains(&i));
        }
        assert_eq!(range.start, n);
        assert!(solid.with_convex_hull().decoration.is_empty());
    }
}
