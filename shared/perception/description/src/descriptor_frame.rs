//! Object frame of a descriptor.

use geometry::RigidTransform;
use point_cloud::Point;

/// Rigid transform `object_from_source` in single precision, as the 3 x 4 matrix `[R |
/// t]`.
///
/// Single precision suffices for points and reproduces the published numbers bit for
/// bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DescriptorFrame {
    /// Rows of `[R | t]`; the translation is in metres.
    pub object_from_source: [[f32; 4]; 3],
}

impl DescriptorFrame {
    /// Transforms a point into the object frame, metres. The additions follow the order
    /// of the Point Cloud Library's vector code: `x c0 + (y c1 + (z c2 + c3))`.
    #[inline]
    pub fn apply(&self, point: &Point) -> [f32; 3] {
        self.object_from_source
            .map(|[c0, c1, c2, c3]| point.x * c0 + (point.y * c1 + (point.z * c2 + c3)))
    }
}

impl From<&RigidTransform> for DescriptorFrame {
    fn from(object_from_source: &RigidTransform) -> Self {
        let matrix = object_from_source.to_homogeneous();
        let row = |i: usize| std::array::from_fn(|j| matrix[(i, j)] as f32);
        Self {
            object_from_source: [row(0), row(1), row(2)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn a_frame_equals_its_rigid_transform() {
        let object_from_source =
            RigidTransform::new(Vector3::new(0.5, -1.0, 2.0), Vector3::new(0.3, 1.0, -0.4));
        let point = Point {
            x: 0.2,
            y: -0.7,
            z: 1.3,
            ..Point::default()
        };
        let expected = object_from_source * point.position();
        let got = DescriptorFrame::from(&object_from_source).apply(&point);
        for i in 0..3 {
            assert!((f64::from(got[i]) - expected[i]).abs() < 1e-6);
        }
    }
}
