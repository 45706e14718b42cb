//! Minimum-area bounding rectangle of a footprint on the table.

use nalgebra::Vector2;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Number of directions of the approximate convex hull. Four preserve the corners of a
/// rectangle; with 24 a circle loses 1 % of its radius.
const N_DIRECTIONS: usize = 24;

/// Number of yaw steps of the rectangle search: one degree each.
const N_YAWS: usize = 90;

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

/// Rectangle in the plane of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rectangle {
    pub(crate) centre: Vector2<f64>,
    /// Half of the longer and of the shorter side, metres.
    pub(crate) half_sides_m: Vector2<f64>,
    /// Direction of the longer side, radians in [-pi/2, pi/2).
    pub(crate) yaw_rad: f64,
}

impl Rectangle {
    /// Separating-axis test: `true` when two rectangles are within a distance of each other
    /// along the sides of both. Slightly early near corners.
    pub(crate) fn overlaps(&self, other: &Self, distance_m: f64) -> bool {
        let between = other.centre - self.centre;
        self.sides().into_iter().chain(other.sides()).all(|side| {
            between.dot(&side).abs() <= self.reach_m(&side) + other.reach_m(&side) + distance_m
        })
    }

    /// Directions of the longer and the shorter side.
    fn sides(&self) -> [Vector2<f64>; 2] {
        let (sin, cos) = self.yaw_rad.sin_cos();
        [Vector2::new(cos, sin), Vector2::new(-sin, cos)]
    }

    /// Half extent of the rectangle along a direction, metres.
    fn reach_m(&self, direction: &Vector2<f64>) -> f64 {
        let [long, short] = self.sides();
        self.half_sides_m.x * long.dot(direction).abs()
            + self.half_sides_m.y * short.dot(direction).abs()
    }
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

    /// Rectangle of least area over all yaw steps; `None` without points.
    pub(crate) fn min_area_rectangle(&self) -> Option<Rectangle> {
        if self.farthest[0] == f32::NEG_INFINITY {
            return None;
        }
        let rectangle = |step: usize| self.rectangle_at(FRAC_PI_2 * step as f64 / N_YAWS as f64);
        let area = |rectangle: &Rectangle| rectangle.half_sides_m.product();
        (0..N_YAWS)
            .map(rectangle)
            .min_by(|a, b| area(a).total_cmp(&area(b)))
    }

    fn rectangle_at(&self, yaw_rad: f64) -> Rectangle {
        let (sin, cos) = yaw_rad.sin_cos();
        let (mut low, mut high) = (Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN));
        for corner in &self.corners {
            let (u, v) = (f64::from(corner[0]), f64::from(corner[1]));
            let turned = Vector2::new(cos * u + sin * v, cos * v - sin * u);
            (low, high) = (low.inf(&turned), high.sup(&turned));
        }
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let centre = Vector2::new(
            cos * middle.x - sin * middle.y,
            sin * middle.x + cos * middle.y,
        );
        if half.x >= half.y {
            Rectangle {
                centre,
                half_sides_m: half,
                yaw_rad,
            }
        } else {
            Rectangle {
                centre,
                half_sides_m: half.yx(),
                yaw_rad: yaw_rad - FRAC_PI_2,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
            let found = footprint.min_area_rectangle().unwrap();
            let turn = (found.yaw_rad - yaw).sin().abs();
            prop_assert!(turn < 0.02, "yaw {} for {}", found.yaw_rad, yaw);
            prop_assert!((found.centre - Vector2::new(shift, 0.0)).norm() < 5e-3);
            prop_assert!((found.half_sides_m - Vector2::new(long, share * long)).norm() < 0.02 * long + 1e-3);
        }
    }

    #[test]
    fn rectangles_touch_across_their_sides() {
        let at = |x: f64, yaw_rad: f64| Rectangle {
            centre: Vector2::new(x, 0.0),
            half_sides_m: Vector2::new(0.2, 0.1),
            yaw_rad,
        };
        let origin = at(0.0, 0.0);
        assert!(origin.overlaps(&at(0.39, 0.0), 0.0) && !origin.overlaps(&at(0.41, 0.0), 0.0));
        assert!(origin.overlaps(&at(0.41, 0.0), 0.02));
        assert!(!origin.overlaps(&at(0.31, FRAC_PI_2), 0.0));
        assert!(origin.overlaps(&at(0.29, FRAC_PI_2), 0.0));
    }

    #[test]
    fn empty_footprint_has_no_rectangle() {
        assert_eq!(Footprint::new().min_area_rectangle(), None);
    }
}
