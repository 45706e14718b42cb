//! Approximate convex hull of a footprint on the table.

use geometry::BoundingRectangle;
use nalgebra::Point2;
use std::f64::consts::TAU;

/// Number of directions of the approximate convex hull. Four preserve the corners of a
/// rectangle; with 24 a circle loses 1 % of its radius.
const N_DIRECTIONS: usize = 24;

/// Insertion stride: points are added in strided order, so that most points are interior
/// when they are tested.
const INSERTION_STRIDE: usize = 61;

/// Approximate convex hull of a planar point set: its extreme point in each of a fixed
/// number of directions.
#[derive(Debug, Clone)]
pub(crate) struct Footprint {
    /// Components of the directions, first and second coordinate.
    directions: [[f32; N_DIRECTIONS]; 2],
    farthest: [f32; N_DIRECTIONS],
    corners: [[f32; 2]; N_DIRECTIONS],
}

impl Footprint {
    pub(crate) fn new() -> Self {
        let angle = |i: usize| TAU * (i as f64 + 0.5) / N_DIRECTIONS as f64;
        Self {
            directions: [
                std::array::from_fn(|i| angle(i).cos() as f32),
                std::array::from_fn(|i| angle(i).sin() as f32),
            ],
            farthest: [f32::NEG_INFINITY; N_DIRECTIONS],
            corners: [[0.0; 2]; N_DIRECTIONS],
        }
    }

    /// Add `n` finite points given in image order, in strided order for speed.
    #[inline]
    pub(crate) fn add_all(&mut self, n: usize, point: impl Fn(usize) -> [f32; 2]) {
        for first in 0..INSERTION_STRIDE.min(n) {
            for i in (first..n).step_by(INSERTION_STRIDE) {
                let [u, v] = point(i);
                self.add(u, v);
            }
        }
    }

    /// Adds a finite point to the footprint.
    #[inline]
    pub(crate) fn add(&mut self, u: f32, v: f32) {
        let [of_u, of_v] = &self.directions;
        let along: [f32; N_DIRECTIONS] = std::array::from_fn(|i| of_u[i] * u + of_v[i] * v);
        // Most points are interior; a few vector instructions reject them.
        let farther = (0..N_DIRECTIONS).filter(|&i| along[i] > self.farthest[i]);
        if farther.count() == 0 {
            return;
        }
        for (i, along) in along.into_iter().enumerate() {
            if along > self.farthest[i] {
                self.farthest[i] = along;
                self.corners[i] = [u, v];
            }
        }
    }

    /// Bounding rectangle in the plane of the table; `None` without points.
    pub(crate) fn bounding_rectangle(&self) -> Option<BoundingRectangle> {
        if self.farthest[0] == f32::NEG_INFINITY {
            return None;
        }
        let corners = self.corners.map(|[u, v]| Point2::new(u.into(), v.into()));
        BoundingRectangle::of_outline(&corners)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rotated_rectangle_is_recovered(
            yaw in -1.57..1.57_f64, long in 0.1..0.3_f64, share in 0.2..0.8_f64, shift in -1.0..1.0_f64,
        ) {
            let mut footprint = Footprint::new();
            for i in 0..=20 {
                for j in 0..=20 {
                    let (a, b) = (long * (f64::from(i) / 10.0 - 1.0), share * long * (f64::from(j) / 10.0 - 1.0));
                    let (sin, cos) = yaw.sin_cos();
                    footprint.add((cos * a - sin * b + shift) as f32, (sin * a + cos * b) as f32);
                }
            }
            let found = footprint.bounding_rectangle().unwrap();
            let turn = (found.yaw_rad - yaw).sin().abs();
            prop_assert!(turn < 0.02, "yaw {} for {}", found.yaw_rad, yaw);
            prop_assert!((found.centre - Point2::new(shift, 0.0)).norm() < 5e-3);
            prop_assert!((found.half_sides_m - Vector2::new(long, share * long)).norm() < 0.02 * long + 1e-3);
        }
    }

    #[test]
    fn empty_footprint_has_no_rectangle() {
        assert_eq!(Footprint::new().bounding_rectangle(), None);
    }
}
