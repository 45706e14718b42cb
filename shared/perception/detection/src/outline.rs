//! The outline of the table, which need not be convex.

use geometry::ConvexPolygon;
use nalgebra::Point2;

/// A closed line around the table, counter-clockwise in the table's frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outline {
    /// Its corners, metres.
    pub corners: Vec<Point2<f64>>,
    /// Whether the side from each corner to the next is the table's rim; other
    /// sides are where the view ends.
    pub is_rim: Vec<bool>,
}

impl Outline {
    /// The outline of a hull whose sides are all rim.
    pub(crate) fn around(hull: &ConvexPolygon) -> Self {
        Self {
            corners: hull.corners().to_vec(),
            is_rim: vec![true; hull.corners().len()],
        }
    }

    /// Whether a place lies inside (even-odd rule).
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

    /// Distance of a place from the rim, metres: negative beyond the rim,
    /// positive on the table and where the view ends before the rim; infinite
    /// without a rim, as when the table fills the view.
    pub fn rim_distance_m(&self, place: &Point2<f64>) -> f64 {
        let (mut rim_m, mut view_end_m) = (f64::INFINITY, f64::INFINITY);
        for (a, b, is_rim) in self.sides() {
            let nearest_m = if is_rim { &mut rim_m } else { &mut view_end_m };
            *nearest_m = nearest_m.min(distance_m(place, &a, &b));
        }
        if rim_m < view_end_m && !self.contains(place) {
            -rim_m
        } else {
            rim_m
        }
    }

    /// Whether a place and all around it up to a distance, metres, lie inside, away
    /// from every side.
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

/// Distance of a place from the segment between two others, metres.
pub(crate) fn distance_m(place: &Point2<f64>, a: &Point2<f64>, b: &Point2<f64>) -> f64 {
    let along = b - a;
    let share = (place - a).dot(&along) / along.norm_squared().max(1e-12);
    (place - (a + along * share.clamp(0.0, 1.0))).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An L of 2 m by 2 m without its upper right quarter.
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
    fn the_inner_corner_is_outside_and_has_a_rim() {
        let outline = l_shape();
        assert!(outline.contains(&Point2::new(0.5, 1.5)));
        assert!(!outline.contains(&Point2::new(1.5, 1.5)));
        assert!((outline.rim_distance_m(&Point2::new(0.9, 1.5)) - 0.1).abs() < 1e-12);
        assert!((outline.rim_distance_m(&Point2::new(1.2, 1.3)) + 0.2).abs() < 1e-12);
    }

    #[test]
    fn where_the_view_ends_is_no_rim() {
        for v in [0.1, -0.1] {
            let distance_m = l_shape().rim_distance_m(&Point2::new(1.0, v));
            assert!((distance_m - 1.0_f64.hypot(v.min(0.0)).min(1.0 - v)).abs() < 1e-12);
        }
    }

    #[test]
    fn an_outline_without_a_rim_is_infinitely_wide() {
        let mut outline = l_shape();
        outline.is_rim.fill(false);
        assert!(outline.rim_distance_m(&Point2::new(0.1, 0.1)) == f64::INFINITY);
        assert!(!Outline::default().contains(&Point2::origin()));
    }
}
