//! The outline of the table, which need not be convex.

use crate::table_surface::TableSurface;
use geometry::ConvexPolygon;
use nalgebra::Point2;

/// Corners are left out where the outline stays this near, metres.
const TOLERANCE_M: f64 = 0.03;

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
    pub(crate) fn holds_around(&self, place: &Point2<f64>, distance_m: f64) -> bool {
        self.contains(place)
            && self
                .sides()
                .all(|(a, b, _)| self::distance_m(place, &a, &b) > distance_m)
    }

    fn sides(&self) -> impl Iterator<Item = (Point2<f64>, Point2<f64>, bool)> {
        let next = self.corners.iter().cycle().skip(1);
        let sides = self.corners.iter().zip(next).zip(&self.is_rim);
        sides.map(|((a, b), is_rim)| (*a, *b, *is_rim))
    }

    /// Follows the border of the table's cells. A side is rim unless it lies
    /// along a side of `hull` that is none.
    pub(crate) fn trace(&mut self, surface: &TableSurface, hull: &Outline, lattice: &mut Lattice) {
        lattice.walk(surface);
        lattice.simplify();
        self.corners.clear();
        let corners = lattice.kept.iter().map(|&i| lattice.corners[i as usize]);
        self.corners.extend(corners);
        self.is_rim.clear();
        for (i, a) in self.corners.iter().enumerate() {
            let b = self.corners[(i + 1) % self.corners.len()];
            // The end of the view may be several sides of the hull.
            let ends_view = |corner: &Point2<f64>| {
                let mut sides = hull.sides().filter(|(_, _, is_rim)| !is_rim);
                sides.any(|(from, to, _)| distance_m(corner, &from, &to) <= TOLERANCE_M)
            };
            let middle = Point2::from(0.5 * (a.coords + b.coords));
            let is_rim = ![*a, middle, b].iter().all(ends_view);
            self.is_rim.push(is_rim);
        }
    }
}

/// Distance of a place from the segment between two others, metres.
fn distance_m(place: &Point2<f64>, a: &Point2<f64>, b: &Point2<f64>) -> f64 {
    let along = b - a;
    let share = (place - a).dot(&along) / along.norm_squared().max(1e-12);
    (place - (a + along * share.clamp(0.0, 1.0))).norm()
}

/// Buffers of the tracing.
#[derive(Debug, Default)]
pub(crate) struct Lattice {
    corners: Vec<Point2<f64>>,
    kept: Vec<u32>,
    open: Vec<[u32; 2]>,
}

impl Lattice {
    /// Walks around the cells of the table, which stay on the left, from the
    /// first cell back to it; keeps the places where the way turns.
    fn walk(&mut self, surface: &TableSurface) {
        const STEPS: [[isize; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
        self.corners.clear();
        let first = (0..surface.width * surface.height)
            .map(|cell| (cell % surface.width, cell / surface.width))
            .find(|&(column, row)| surface.is_table_cell(column as isize, row as isize));
        let Some((column, row)) = first else { return };
        let start = [column as isize, row as isize];
        let (mut at, mut heading) = (start, 0);
        loop {
            at = [at[0] + STEPS[heading][0], at[1] + STEPS[heading][1]];
            // The cells ahead, to the left and to the right of the way.
            let [x, y] = at;
            let [left, right] = match heading {
                0 => [[x, y], [x, y - 1]],
                1 => [[x - 1, y], [x, y]],
                2 => [[x - 1, y - 1], [x - 1, y]],
                _ => [[x, y - 1], [x - 1, y - 1]],
            }
            .map(|[column, row]| surface.is_table_cell(column, row));
            let turned = match (left, right) {
                (false, _) => (heading + 1) % 4,
                (true, true) => (heading + 3) % 4,
                (true, false) => heading,
            };
            if turned != heading {
                self.corners.push(surface.corner(x as usize, y as usize));
            }
            heading = turned;
            if at == start && heading == 0 {
                return;
            }
        }
    }

    /// Keeps the corners that the outline needs (Douglas and Peucker 1973).
    fn simplify(&mut self) {
        let Self {
            corners,
            kept,
            open,
        } = self;
        kept.clear();
        open.clear();
        let n = corners.len() as u32;
        if n == 0 {
            return;
        }
        let far = (0..n).max_by(|&a, &b| {
            let from_first = |i: u32| (corners[i as usize] - corners[0]).norm_squared();
            from_first(a).total_cmp(&from_first(b))
        });
        let far = far.unwrap_or(0);
        kept.extend([0, far]);
        open.extend([[0, far], [far, n]]);
        while let Some([from, to]) = open.pop() {
            let ends = [from, to % n].map(|i| corners[i as usize]);
            let away = |i: u32| distance_m(&corners[i as usize], &ends[0], &ends[1]);
            let farthest = (from + 1..to).max_by(|&a, &b| away(a).total_cmp(&away(b)));
            if let Some(i) = farthest.filter(|&i| away(i) > TOLERANCE_M) {
                kept.push(i);
                open.extend([[from, i], [i, to]]);
            }
        }
        kept.sort_unstable();
        kept.dedup();
    }
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
