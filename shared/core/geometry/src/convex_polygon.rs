//! Convex polygon in a plane, and the convex hull of points.

use nalgebra::Point2;

/// Convex polygon, counter-clockwise, metres.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ConvexPolygon {
    corners: Vec<Point2<f64>>,
}

impl ConvexPolygon {
    /// Convex hull of finite points by the monotone chain (Andrew 1979), O(n log n). Sorts `points`
    /// in place. Collinear points give an empty polygon, which contains nothing.
    pub fn convex_hull_of(points: &mut [Point2<f64>]) -> Self {
        let mut hull = Self::default();
        hull.assign_convex_hull_of(points);
        hull
    }

    /// Replaces this polygon by a convex hull, as [`convex_hull_of`](Self::convex_hull_of), and reuses its
    /// memory.
    pub fn assign_convex_hull_of(&mut self, points: &mut [Point2<f64>]) {
        let corners = &mut self.corners;
        corners.clear();
        points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        extend_monotone_chain(corners, 0, points.iter());
        let lower = corners.len().saturating_sub(1);
        corners.truncate(lower);
        extend_monotone_chain(corners, lower, points.iter().rev());
        corners.pop();
        if corners.len() < 3 {
            corners.clear();
        }
    }

    /// Corners of the polygon, counter-clockwise.
    pub fn corners(&self) -> &[Point2<f64>] {
        &self.corners
    }

    /// True if the point lies inside or on the border.
    #[inline]
    pub fn contains(&self, point: &Point2<f64>) -> bool {
        !self.corners.is_empty() && self.edges().all(|(a, b)| cross(a, b, point) >= 0.0)
    }

    /// Signed distance of a point to the border, metres, positive inside. Outside: the negated
    /// distance to the farthest violated edge line. Minus infinity for an empty polygon.
    pub fn signed_distance_m(&self, point: &Point2<f64>) -> f64 {
        if self.corners.is_empty() {
            return f64::NEG_INFINITY;
        }
        self.edges()
            .map(|(a, b)| cross(a, b, point) / (b - a).norm())
            .fold(f64::INFINITY, f64::min)
    }

    /// Area of the polygon, square metres.
    pub fn area_m2(&self) -> f64 {
        self.edges()
            .map(|(a, b)| 0.5 * (a.x * b.y - b.x * a.y))
            .sum()
    }

    fn edges(&self) -> impl Iterator<Item = (&Point2<f64>, &Point2<f64>)> {
        self.corners.iter().zip(self.corners.iter().cycle().skip(1))
    }
}

/// Appends one chain of the convex hull to `corners`, without removing corners before index
/// `from`.
fn extend_monotone_chain<'a>(
    corners: &mut Vec<Point2<f64>>,
    from: usize,
    points: impl Iterator<Item = &'a Point2<f64>>,
) {
    for point in points {
        while corners.len() >= from + 2
            && cross(
                &corners[corners.len() - 2],
                &corners[corners.len() - 1],
                point,
            ) <= 0.0
        {
            corners.pop();
        }
        corners.push(*point);
    }
}

/// Twice the signed area of the triangle a, b, p; positive when p is left of a→b.
#[inline]
fn cross(a: &Point2<f64>, b: &Point2<f64>, p: &Point2<f64>) -> f64 {
    (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(max: usize) -> impl Strategy<Value = Vec<Point2<f64>>> {
        prop::collection::vec(
            (-3.0..3.0, -3.0..3.0).prop_map(|(x, y)| Point2::new(x, y)),
            0..max,
        )
    }

    proptest! {
        #[test]
        fn a_hull_contains_its_points_and_is_convex(mut cloud in points(60)) {
            let hull = ConvexPolygon::convex_hull_of(&mut cloud);
            let corners = hull.corners();
            for i in 0..corners.len() {
                let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
                let c = corners[(i + 2) % corners.len()];
                prop_assert!(cross(&a, &b, &c) > 0.0);
            }
            if corners.len() >= 3 {
                for p in &cloud {
                    prop_assert!(hull.signed_distance_m(p) > -1e-9);
                }
                prop_assert!(hull.area_m2() > 0.0);
            }
        }
    }

    #[test]
    fn a_square_knows_its_area_and_border() {
        let at = |x: f64, y: f64| Point2::new(x, y);
        let mut cloud = [
            at(0.0, 0.0),
            at(2.0, 0.0),
            at(1.0, 1.0),
            at(2.0, 2.0),
            at(0.0, 2.0),
        ];
        let square = ConvexPolygon::convex_hull_of(&mut cloud);
        assert_eq!(square.corners().len(), 4);
        assert!((square.area_m2() - 4.0).abs() < 1e-12);
        assert!((square.signed_distance_m(&at(0.5, 1.0)) - 0.5).abs() < 1e-12);
        assert!(square.contains(&at(2.0, 1.0)) && !square.contains(&at(2.1, 1.0)));
    }

    #[test]
    fn points_on_a_line_enclose_nothing() {
        let mut line: Vec<_> = (0..9).map(|i| Point2::new(f64::from(i), 2.0)).collect();
        let hull = ConvexPolygon::convex_hull_of(&mut line);
        assert!(hull.corners().is_empty() && !hull.contains(&Point2::new(1.0, 2.0)));
    }
}
