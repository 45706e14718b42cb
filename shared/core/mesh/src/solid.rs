//! A mesh together with its convex parts.

use crate::closed_surface::{CREASE_RAD, turn_outwards};
use crate::{ConvexPart, Surface, TriangleMesh};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use std::ops::Range;

/// A body in the making: what is seen of it, and what it bumps into things
/// with. Each builder gives one; they are painted, moved and joined.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Solid {
    /// Closed surface that looks outwards.
    pub mesh: TriangleMesh,
    /// Convex bodies that together fill it, to a few millimetres.
    pub convex_parts: Vec<ConvexPart>,
    /// Triangles of the mesh that no convex part stands for: details that touch
    /// nothing.
    pub decoration: Vec<Range<usize>>,
}

impl Solid {
    /// Coloured by position and normal, in the solid's present frame.
    pub fn painted(mut self, color: impl Fn(&Point3<f32>, &Vector3<f32>) -> [u8; 3]) -> Self {
        self.mesh.paint(color);
        self
    }

    /// In one colour.
    pub fn colored(self, color: [u8; 3]) -> Self {
        self.painted(|_, _| color)
    }

    /// With all faces of one surface.
    pub fn with_surface(mut self, surface: Surface) -> Self {
        self.mesh.set_surface(surface);
        self
    }

    /// Moved by a displacement.
    pub fn moved(self, x: f32, y: f32, z: f32) -> Self {
        self.placed(&Isometry3::translation(x, y, z))
    }

    /// Turned about an axis through the origin, right-handed.
    pub fn turned(self, axis: Vector3<f32>, angle_rad: f32) -> Self {
        let axis = nalgebra::Unit::new_normalize(axis);
        let rotation = UnitQuaternion::from_axis_angle(&axis, angle_rad);
        self.placed(&Isometry3::from_parts(
            nalgebra::Translation3::identity(),
            rotation,
        ))
    }

    /// Moved by `target_from_source`.
    pub fn placed(mut self, pose: &Isometry3<f32>) -> Self {
        self.mesh.transform(pose);
        for part in &mut self.convex_parts {
            part.transform(pose);
        }
        self
    }

    /// Deformed by a continuous map of space; normals are found anew.
    pub fn warped(mut self, map: impl Fn(Point3<f32>) -> Point3<f32>) -> Self {
        for vertex in &mut self.mesh.vertices {
            vertex.position = map(vertex.position);
        }
        turn_outwards(&mut self.mesh);
        self.mesh.smooth_normals(CREASE_RAD);
        for point in self.convex_parts.iter_mut().flat_map(|p| &mut p.points) {
            *point = map(*point);
        }
        self
    }

    /// Stretched along the axes by factors other than zero.
    pub fn stretched(self, x: f32, y: f32, z: f32) -> Self {
        self.warped(|p| Point3::new(p.x * x, p.y * y, p.z * z))
    }

    /// Together with another one.
    pub fn joined(mut self, other: Self) -> Self {
        let first = self.mesh.triangles.len();
        let decoration = other.decoration.into_iter();
        self.decoration
            .extend(decoration.map(|range| range.start + first..range.end + first));
        self.mesh.append(&other.mesh);
        self.convex_parts.extend(other.convex_parts);
        self
    }

    /// With one convex part around all of it, for what is filled by that well
    /// enough or too fine to be bumped into in detail.
    pub fn hulled(mut self) -> Self {
        let points = self.mesh.vertices.iter().map(|v| v.position).collect();
        self.convex_parts = vec![ConvexPart::around(points)];
        self.decoration.clear();
        self
    }

    /// Without convex parts, for details that touch nothing.
    pub fn decorative(mut self) -> Self {
        self.convex_parts.clear();
        self.decoration = std::iter::once(0..self.mesh.triangles.len()).collect();
        self
    }

    /// With the centre of its bounding box at the origin.
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
        assert!(solid.hulled().decoration.is_empty());
    }
}
