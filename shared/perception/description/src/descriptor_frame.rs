//! The frame a descriptor is computed in.

use geometry::RigidTransform;
use point_cloud::Point;

/// A rigid transform in single precision, `object_from_source`, as the 3 x 4
/// matrix `[R | t]`: it brings points of the cloud's frame to the object's.
///
/// Single precision is enough for points, and lets the published numbers be
/// reproduced to the last bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DescriptorFrame {
    /// Rows of `[R | t]`; the translation in metres.
    pub object_from_source: [[f32; 4]; 3],
}

impl DescriptorFrame {
    /// The point in the object's frame, metres. The order of the additions is that
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
    fn a_frame_moves_points_as_its_transform_does() {
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
