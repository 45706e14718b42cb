//! Oriented bounding box.

use nalgebra::{Isometry3, Point3, Vector3};

/// Oriented box: centred at the origin of its own frame, sides along the axes of that frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrientedBox {
    /// Pose of the box in its reference frame: `frame_from_box`.
    pub frame_from_box: Isometry3<f64>,
    /// Half side lengths of the box, metres, all >= 0.
    pub half_sides_m: Vector3<f64>,
}

impl OrientedBox {
    /// Centre of the box in the reference frame, metres.
    pub fn centre(&self) -> Point3<f64> {
        self.frame_from_box.translation.vector.into()
    }

    /// Side lengths of the box, metres.
    pub fn sides_m(&self) -> Vector3<f64> {
        2.0 * self.half_sides_m
    }

    /// Corners of the box in the reference frame; bit `i` of the index is set on the positive side of
    /// axis `i`.
    pub fn corners(&self) -> [Point3<f64>; 8] {
        std::array::from_fn(|index| {
            let sign = Vector3::from_fn(|axis, _| if index >> axis & 1 == 1 { 1.0 } else { -1.0 });
            self.frame_from_box * Point3::from(self.half_sides_m.component_mul(&sign))
        })
    }

    /// Volume of the box, cubic metres.
    pub fn volume_m3(&self) -> f64 {
        self.sides_m().product()
    }

    /// True if a point lies in the box enlarged by `margin_m` on every side.
    #[inline]
    pub fn contains(&self, point: &Point3<f64>, margin_m: f64) -> bool {
        let p = self.frame_from_box.inverse_transform_point(point);
        (0..3).all(|i| p[i].abs() <= self.half_sides_m[i] + margin_m)
    }

    /// Bounding-sphere test: true if two boxes may come within `margin_m` of each other. False for
    /// a box with a NaN.
    #[inline]
    pub fn bounding_spheres_meet(&self, other: &Self, margin_m: f64) -> bool {
        let reach_m = self.half_sides_m.norm() + other.half_sides_m.norm() + margin_m;
        (self.centre() - other.centre()).norm() <= reach_m
    }

    /// Box transformed into another frame.
    pub fn transformed(&self, target_from_frame: &Isometry3<f64>) -> Self {
        Self {
            frame_from_box: target_from_frame * self.frame_from_box,
            ..*self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_keeps_its_content_when_it_moves() {
        let small = OrientedBox {
            frame_from_box: Isometry3::new(
                Vector3::new(1.0, 2.0, 3.0),
                Vector3::new(0.1, 0.5, 1.0),
            ),
            half_sides_m: Vector3::new(0.1, 0.2, 0.3),
        };
        let inside = small.frame_from_box * Point3::new(0.09, -0.19, 0.29);
        let outside = small.frame_from_box * Point3::new(0.11, 0.0, 0.0);
        let motion = Isometry3::new(Vector3::new(-4.0, 0.0, 0.2), Vector3::new(2.0, 0.0, 0.3));
        let moved = small.transformed(&motion);
        assert!(small.contains(&inside, 0.0) && moved.contains(&(motion * inside), 1e-9));
        assert!(!small.contains(&outside, 0.0) && small.contains(&outside, 0.02));
        assert!((moved.volume_m3() - 0.2 * 0.4 * 0.6).abs() < 1e-12);
    }

    #[test]
    fn boxes_may_meet_as_far_as_their_corners_reach() {
        let cube = |x: f64| OrientedBox {
            frame_from_box: Isometry3::translation(x, 0.0, 0.0),
            half_sides_m: Vector3::repeat(1.0),
        };
        let reach_m = 2.0 * 3.0_f64.sqrt();
        assert!(cube(0.0).bounding_spheres_meet(&cube(reach_m - 1e-9), 0.0));
        assert!(!cube(0.0).bounding_spheres_meet(&cube(reach_m + 0.1), 0.0));
        assert!(cube(0.0).bounding_spheres_meet(&cube(reach_m + 0.1), 0.11));
        assert!(!cube(0.0).bounding_spheres_meet(&cube(f64::NAN), 1.0));
    }
}
