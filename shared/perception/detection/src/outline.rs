//! Table outline: a possibly concave polygon with rim marks.

use geometry::ConvexPolygon;
use nalgebra::Point2;

/// Outline polygon of the table, counter-clockwise in the table's frame, possibly concave.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outline {
    /// Corners of the outline, metres.
    pub corners: Vec<Point2<f64>>,
    /// Per side, from each corner to the next: `true` on the table's rim, beyond which free
    /// space is visible; `false` where an object hides the rest or the view ends.
    pub is_rim: Vec<bool>,
}

impl Outline {
    /// Outline of a convex hull with all sides marked as rim.
    pub(crate) fn around(hull: &ConvexPolygon) -> Self {
        let mut outline = Self::default();
        outline.assign_hull(hull);
        outline
    }

    /// Assign a convex hull with all sides marked as rim.
    pub(crate) fn assign_hull(&mut self, hull: &ConvexPolygon) {
        self.corners.clear();
        self.corners.extend_from_slice(hull.corners());
        self.is_rim.clear();
        self.is_rim.resize(self.corners.len(), true);
    }

    /// Point-in-polygon test (even-odd rule).
    pub fn contains(&self, place: &Point2<f64>) -> bool {
        self.sides()
            .filter(|(a, b, _)| {
                (a.y > place.y) != (b.y > place.y)
                    && place.x < a.x + (place.y - a.y) / (b.y - a.y) * (b.x - a.x)
            })
            .count()
            % 2
            == 1
    }

    /// Signed distance of a point from the rim, metres: negative beyond the rim, positive
    /// on the table and where the view ends before the rim. Infinite without a rim, for
    /// example when the table fills the view.
    pub fn rim_distance_m(&self, place: &Point2<f64>) -> f64 {
        self.border_distances_m(place)[0]
    }

    /// [Signed distance](Self::rim_distance_m) of a point from the rim, and distance from
    /// the border that is hidden or outside of the view, metres; infinite without any.
    pub fn border_distances_m(&self, place: &Point2<f64>) -> [f64; 2] {
        let (mut rim_m, mut unseen_m) = (f64::INFINITY, f64::INFINITY);
        for (a, b, is_rim) in self.sides() {
            let nearest_m = if is_rim { &mut rim_m } else { &mut unseen_m };
            *nearest_m = nearest_m.min(distance_m(place, &a, &b));
        }
        if rim_m < unseen_m && !self.contains(place) {
            [-rim_m, unseen_m]
        } else {
            [rim_m, unseen_m]
        }
    }

    /// `true` when a disc of radius `distance_m`, metres, around a point is inside the
    /// outline.
    pub(crate) fn contains_disc(&self, place: &Point2<f64>, distance_m: f64) -> bool {
        self.contains(place)
            && self
                .sides()
                .all(|(a, b, _)| self::distance_m(place, &a, &b) > distance_m)
    }

    pub(crate) fn sides(&self) -> impl Iterator<Item = (Point2<f64>, Point2<f64>, bool)> {
        let next = self.corners.iter().cycle().skip(1);
        let sides = self.corners.iter().zip(next).zip(&self.is_rim);
        sides.map(|((a, b), is_rim)| (*a, *b, *is_rim))
    }
}

/// Distance of a point from a line segment, metres.
pub(crate) fn distance_m(place: &Point2<f64>, a: &Point2<f64>, b: &Point2<f64>) -> f64 {
    let along = b - a;
    let share = (place - a).dot(&along) / along.norm_squared().max(1e-12);
    (place - (a + along * share.clamp(0.0, 1.0))).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// L shape of 2 m by 2 m without its upper right quarter.
    fn l_shape() -> Outline {
        let corners = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ];
        Outline {
            corners: corners.map(Point2::from).into(),
            is_rim: vec![false, true, true, true, true, true],
        }
    }

    #[test]
    fn concave_corner_is_outside_and_has_a_rim() {
        let outline = l_shape();
        assert!(outline.contains(&Point2::new(0.5, 1.5)));
        assert!(!outline.contains(&Point2::new(1.5, 1.5)));
        assert!((outline.rim_distance_m(&Point2::new(0.9, 1.5)) - 0.1).abs() < 1e-12);
        assert!((outline.rim_distance_m(&Point2::new(1.2, 1.3)) + 0.2).abs() < 1e-12);
    }

    #[test]
    fn view_end_sides_are_not_rim() {
        for v in [0.1, -0.1] {
            let distance_m = l_shape().rim_distance_m(&Point2::new(1.0, v));
            assert!((distance_m - 1.0_f64.hypot(v.min(0.0)).min(1.0 - v)).abs() < 1e-12);
        }
    }

    #[test]
    fn outline_without_rim_has_infinite_rim_distance() {
        let mut outline = l_shape();
        outline.is_rim.fill(false);
        assert!(outline.rim_distance_m(&Point2::new(0.1, 0.1)) == f64::INFINITY);
        assert!(!Outline::default().contains(&Point2::origin()));
    }
}
