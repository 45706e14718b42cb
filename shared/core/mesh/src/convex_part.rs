//! Convex parts: collision shapes for a physics engine.

use nalgebra::{Isometry3, Point3, Vector3};
use std::f32::consts::PI;

/// Maximum number of points of a convex part made by a builder.
pub const MAX_HULL_POINTS: usize = 64;
/// Minimum number of points of a reduced convex part. Chosen.
const N_POINTS_MIN: usize = 32;
/// Tolerance of round surfaces, inside or outside, metres. Chosen: finer facets let bodies roll
/// and jitter.
const ROUND_TOLERANCE_M: f32 = 0.0012;

/// Convex body: convex hull of points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ConvexPart {
    /// Points whose convex hull is the body, metres; interior points are allowed.
    pub points: Vec<Point3<f32>>,
}

impl ConvexPart {
    /// Convex hull of points, reduced to at most [`MAX_HULL_POINTS`] points, fewer for thin bodies.
    /// Kept are the support points in evenly spread directions, in the bounding box scaled to a
    /// cube.
    pub fn around(points: Vec<Point3<f32>>) -> Self {
        let Some(bounds) = crate::Bounds::of(points.iter().copied()) else {
            return Self::default();
        };
        let sides = bounds.sides().map(|side| side.max(1e-6));
        let n = n_points(sides);
        if points.len() <= n {
            return Self { points };
        }
        let mut kept: Vec<usize> = (0..n)
            .filter_map(|i| support_point(&points, fibonacci_direction(i, n).component_div(&sides)))
            .collect();
        kept.sort_unstable();
        kept.dedup();
        Self {
            points: kept.into_iter().map(|i| points[i]).collect(),
        }
    }

    /// Transforms the part by `pose`, which is `target_from_source`.
    pub fn transform(&mut self, pose: &Isometry3<f32>) {
        for point in &mut self.points {
            *point = pose * *point;
        }
    }

    /// Distance of a point from the body, metres; 0 inside, infinite for a part without points.
    /// Accurate to 0.01 mm, in rare cases 0.1 mm.
    ///
    /// The nearest point of the hull is found as a mixture of its points by
    /// steps that move weight from the worst of them to the best (Mitchell,
    /// Dem'yanov and Malozemov 1974).
    pub fn distance(&self, point: &Point3<f32>) -> f32 {
        let offsets: Vec<Vector3<f64>> = self
            .points
            .iter()
            .map(|corner| (corner - point).cast())
            .collect();
        let Some(mut nearest) = offsets.first().copied() else {
            return f32::INFINITY;
        };
        let mut weights = vec![0.0; offsets.len()];
        weights[0] = 1.0;
        for _ in 0..400 {
            let by = |i: &usize| offsets[*i].dot(&nearest);
            let all = 0..offsets.len();
            let best = all.clone().min_by(|a, b| by(a).total_cmp(&by(b)));
            let used = all.filter(|&i| weights[i] > 0.0);
            let worst = used.max_by(|a, b| by(a).total_cmp(&by(b)));
            let (Some(best), Some(worst)) = (best, worst) else {
                break;
            };
            if nearest.norm_squared() - by(&best) < 1e-5 * nearest.norm().max(1e-7) {
                break;
            }
            let step = offsets[best] - offsets[worst];
            let share = (-nearest.dot(&step) / step.norm_squared()).clamp(0.0, weights[worst]);
            weights[best] += share;
            weights[worst] -= share;
            nearest += step * share;
        }
        nearest.norm() as f32
    }
}

/// Number of points for a round body of this size. The faces between `n` points on a sphere, 2
/// n − 4 triangles of equal area, lie 4.84 / (2 n − 4) of its radius below the points.
fn n_points(sides: Vector3<f32>) -> usize {
    let thickness = sides.sum() - sides.max() - sides.min();
    let n = 2.0 + 0.25 * 4.84 * 0.5 * thickness / ROUND_TOLERANCE_M;
    (n as usize).clamp(N_POINTS_MIN, MAX_HULL_POINTS)
}

/// Scale of `n` points on a sphere that balances the error of their faces inside and outside of
/// it.
pub(crate) fn sphere_inflation(n: usize) -> f32 {
    1.0 + 2.42 / (2 * n.max(4) - 4) as f32
}

/// Number of polygon sides for a circle.
pub(crate) fn n_sides(radius_m: f32) -> usize {
    let half_angle = (1.0 - 2.0 * ROUND_TOLERANCE_M / radius_m).clamp(0.5, 1.0);
    ((PI / half_angle.acos()).ceil() as usize).clamp(6, 16)
}

/// Scale of a regular polygon that balances the error of its sides inside and outside of the
/// circle.
pub(crate) fn circle_inflation(n_sides: usize) -> f32 {
    1.0 / (PI / n_sides as f32).cos().sqrt()
}

/// Evenly spread unit vector: element `i` of a Fibonacci lattice of `n`.
fn fibonacci_direction(i: usize, n: usize) -> Vector3<f32> {
    let z = 1.0 - (2.0 * i as f32 + 1.0) / n as f32;
    let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
    let r = (1.0 - z * z).sqrt();
    Vector3::new(r * cos, r * sin, z)
}

fn support_point(points: &[Point3<f32>], fibonacci_direction: Vector3<f32>) -> Option<usize> {
    let along = |i: &usize| points[*i].coords.dot(&fibonacci_direction);
    (0..points.len()).max_by(|a, b| along(a).total_cmp(&along(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ellipsoid;

    #[test]
    fn the_distance_from_a_cube_is_that_of_the_clamped_point() {
        let side = |i: usize, bit: usize| if i >> bit & 1 == 0 { -0.1 } else { 0.1 };
        let cube = ConvexPart {
            points: (0..8)
                .map(|i| Point3::new(side(i, 0), side(i, 1), side(i, 2)))
                .collect(),
        };
        for i in 0..200 {
            let p = Point3::from(fibonacci_direction(i % 64, 64) * (0.01 + 0.002 * i as f32));
            let clamped = p.map(|x| x.clamp(-0.1, 0.1));
            let expected = (p - clamped).norm();
            assert!((cube.distance(&p) - expected).abs() < 1e-4, "{p}");
        }
        assert_eq!(
            ConvexPart::default().distance(&Point3::origin()),
            f32::INFINITY
        );
    }

    #[test]
    fn few_points_stand_for_a_ball() {
        let ball = ellipsoid([0.05, 0.05, 0.05], 32);
        let part = ConvexPart::around(ball.mesh.vertices.iter().map(|v| v.position).collect());
        assert!(part.points.len() <= MAX_HULL_POINTS);
        for vertex in &ball.mesh.vertices {
            assert!(part.distance(&vertex.position) < 0.09 * 0.05);
        }
    }
}
