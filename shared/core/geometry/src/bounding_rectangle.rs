//! Bounding rectangle of a planar outline.

use nalgebra::{Point2, Rotation2, Vector2};
use std::f64::consts::{FRAC_PI_2, PI};

/// Outlines without a direction: greatest ratio between the areas of their bounding rectangles.
/// A disc has 1, a cup with its handle about 1.1 to 1.2, a square 2. Chosen.
const DIRECTIONLESS_RATIO_MAX: f64 = 1.22;

/// Number of turned rectangles that are compared within a quarter turn.
const N_TURNS: usize = 6;

/// Bounding rectangle of a planar outline, metres.
///
/// The rectangle of least area, if the outline has a direction. The rectangles around a disc with
/// something that sticks out, a cup with its handle, are all of about the same area; the smallest
/// lies to the left or to the right of the handle by chance. Such an outline takes the rectangle
/// along the principal axis of its area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingRectangle {
    /// Middle of the rectangle, metres.
    pub centre: Point2<f64>,
    /// Half of the longer and of the shorter side, metres.
    pub half_sides_m: Vector2<f64>,
    /// Direction of the longer side, radians in [-π/2, π/2).
    pub yaw_rad: f64,
}

impl BoundingRectangle {
    /// Bounding rectangle of a convex outline, given by its corners in counter-clockwise order, in
    /// which corners may be repeated; `None` without corners. O(n²).
    pub fn of_outline(corners: &[Point2<f64>]) -> Option<Self> {
        let smallest = Self::of_least_area(corners)?;
        let quarter = (0..N_TURNS).map(|turn| FRAC_PI_2 * turn as f64 / N_TURNS as f64);
        let largest_m2 = quarter
            .map(|turn_rad| Self::at_yaw(corners, smallest.yaw_rad + turn_rad).area_m2())
            .fold(0.0, f64::max);
        if largest_m2 >= DIRECTIONLESS_RATIO_MAX * smallest.area_m2() {
            return Some(smallest);
        }
        let axis_rad = principal_axis_rad(corners);
        Some(axis_rad.map_or(smallest, |yaw_rad| Self::at_yaw(corners, yaw_rad)))
    }

    /// Rectangle of least area: one of its sides lies on an edge of the outline (Freeman and
    /// Shapira 1975).
    fn of_least_area(corners: &[Point2<f64>]) -> Option<Self> {
        let first = corners.first()?;
        let edges = corners.iter().zip(corners.iter().cycle().skip(1));
        edges
            .map(|(a, b)| b - a)
            .filter(|edge| edge.norm_squared() > 0.0)
            .map(|edge| Self::at_yaw(corners, edge.y.atan2(edge.x)))
            .min_by(|a, b| a.area_m2().total_cmp(&b.area_m2()))
            .or(Some(Self {
                centre: *first,
                half_sides_m: Vector2::zeros(),
                yaw_rad: 0.0,
            }))
    }

    /// Bounding rectangle of points, with one of its sides along a direction, radians.
    pub fn at_yaw(points: &[Point2<f64>], yaw_rad: f64) -> Self {
        let turned_from_plane = Rotation2::new(-yaw_rad);
        let mut low = Point2::new(f64::MAX, f64::MAX);
        let mut high = Point2::new(f64::MIN, f64::MIN);
        for point in points {
            let turned = turned_from_plane * point;
            (low, high) = (low.inf(&turned), high.sup(&turned));
        }
        let half = 0.5 * (high - low);
        let centre = turned_from_plane.inverse() * nalgebra::center(&low, &high);
        let (half_sides_m, yaw_rad) = if half.x >= half.y {
            (half, yaw_rad)
        } else {
            (half.yx(), yaw_rad + FRAC_PI_2)
        };
        Self {
            centre,
            half_sides_m,
            yaw_rad: yaw_rad - PI * (yaw_rad / PI + 0.5).floor(),
        }
    }

    /// Area of the rectangle, square metres.
    pub fn area_m2(&self) -> f64 {
        4.0 * self.half_sides_m.product()
    }

    /// Separating-axis test: `true` when two rectangles are within a distance of each other along
    /// the sides of both. Slightly early near corners.
    pub fn overlaps(&self, other: &Self, distance_m: f64) -> bool {
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

/// Direction of the principal axis of an outline's area, radians; `None` if it has no area or no
/// direction.
fn principal_axis_rad(corners: &[Point2<f64>]) -> Option<f64> {
    let origin = corners.first()?;
    let (mut area, mut first, mut second) = (0.0, Vector2::zeros(), [0.0; 3]);
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        // Moments of the triangle between the first corner and an edge.
        let (a, b) = (a - origin, b - origin);
        let twice_m2 = a.perp(&b);
        area += 0.5 * twice_m2;
        first += (a + b) * (twice_m2 / 6.0);
        let product = |i: usize, j: usize| {
            let (sum_i, sum_j) = (a[i] + b[i], a[j] + b[j]);
            twice_m2 / 24.0 * (a[i] * a[j] + b[i] * b[j] + sum_i * sum_j)
        };
        second[0] += product(0, 0);
        second[1] += product(0, 1);
        second[2] += product(1, 1);
    }
    if area <= 0.0 {
        return None;
    }
    let mean = first / area;
    let xx = second[0] - area * mean.x * mean.x;
    let xy = second[1] - area * mean.x * mean.y;
    let yy = second[2] - area * mean.y * mean.y;
    let (sine, cosine) = (2.0 * xy, xx - yy);
    (sine != 0.0 || cosine != 0.0).then(|| 0.5 * sine.atan2(cosine))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ConvexPolygon;
    use proptest::prelude::*;

    fn turned(yaw_rad: f64, x: f64, y: f64) -> Point2<f64> {
        Rotation2::new(yaw_rad) * Point2::new(x, y)
    }

    fn hull_of(mut points: Vec<Point2<f64>>) -> Vec<Point2<f64>> {
        ConvexPolygon::convex_hull_of(&mut points)
            .corners()
            .to_vec()
    }

    /// Disc of radius 40 mm with a handle of 10 mm width that ends at a distance from its middle.
    fn cup(yaw_rad: f64, handle_m: f64) -> Vec<Point2<f64>> {
        let rim = (0..72).map(|i| Rotation2::new(f64::from(i).to_radians() * 5.0));
        let mut points: Vec<_> = rim.map(|turn| turn * Point2::new(0.04, 0.0)).collect();
        points.extend([-0.005, 0.005].map(|y| turned(yaw_rad, handle_m, y)));
        hull_of(points)
    }

    proptest! {
        #[test]
        fn a_turned_rectangle_is_recovered(
            yaw in -1.57..1.57_f64, long in 0.1..0.3_f64, share in 0.2..0.95_f64, x in -1.0..1.0_f64,
        ) {
            let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
            let outline = corners.map(|[u, v]| {
                turned(yaw, u * long, v * share * long) + Vector2::new(x, 0.2)
            });
            let found = BoundingRectangle::of_outline(&outline).unwrap();
            prop_assert!((found.yaw_rad - yaw).sin().abs() < 1e-6);
            prop_assert!((-FRAC_PI_2..FRAC_PI_2).contains(&found.yaw_rad));
            prop_assert!((found.centre - Point2::new(x, 0.2)).norm() < 1e-9);
            prop_assert!((found.half_sides_m - Vector2::new(long, share * long)).norm() < 1e-9);
        }

        #[test]
        fn the_rectangle_of_a_cup_lies_along_its_handle(yaw in -1.57..1.57_f64, handle in 0.055..0.07_f64) {
            let outline = cup(yaw, handle);
            let found = BoundingRectangle::of_outline(&outline).unwrap();
            prop_assert!((found.yaw_rad - yaw).sin().abs() < 0.02, "{} for {yaw}", found.yaw_rad);
            let middle = turned(yaw, 0.5 * (handle - 0.04), 0.0);
            prop_assert!((found.centre - middle).norm() < 1e-3);
        }
    }

    #[test]
    fn the_smallest_rectangle_of_a_cup_leans_to_one_side() {
        let outline = cup(0.3, 0.065);
        let smallest = BoundingRectangle::of_least_area(&outline).unwrap();
        assert!(
            (smallest.yaw_rad - 0.3).sin().abs() > 0.3,
            "{}",
            smallest.yaw_rad
        );
    }

    #[test]
    fn rectangles_touch_across_their_sides() {
        let at = |x: f64, yaw_rad: f64| BoundingRectangle {
            centre: Point2::new(x, 0.0),
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
    fn points_and_lines_have_a_rectangle_without_area() {
        assert_eq!(BoundingRectangle::of_outline(&[]), None);
        let point = BoundingRectangle::of_outline(&[Point2::new(1.0, 2.0); 3]).unwrap();
        assert_eq!(
            (point.centre, point.area_m2()),
            (Point2::new(1.0, 2.0), 0.0)
        );
        let line = [Point2::new(0.0, 0.0), Point2::new(3.0, 4.0)];
        let line = BoundingRectangle::of_outline(&line).unwrap();
        assert!((line.half_sides_m - Vector2::new(2.5, 0.0)).norm() < 1e-12);
    }
}
