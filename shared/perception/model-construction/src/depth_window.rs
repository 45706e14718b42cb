//! Window of a depth image: the pixels of one object, and their distances from its borders.

use point_cloud::Point;

/// Depth step between neighbouring pixels, as a share of the depth, from which both are a border.
/// Chosen: 1.6 cm at 0.8 m, more than the steps of a slanted surface.
const STEP_SHARE: f32 = 0.02;

/// Greatest distance from a border that is told, pixels.
pub(crate) const BORDER_DISTANCE_MAX_PX: u8 = 3;

/// Index in place of that of a point.
const NO_POINT: u32 = u32::MAX;

/// Neighbours of a pixel.
const AROUND: [[i32; 2]; 4] = [[1, 0], [-1, 0], [0, 1], [0, -1]];

/// Pixels around the points of an object, each with the nearest point in it.
#[derive(Debug)]
pub(crate) struct DepthWindow {
    /// Column and row of the first pixel.
    first: [i32; 2],
    /// Width and height, pixels.
    size: [i32; 2],
    /// Index of the point of each pixel, row-major; `NO_POINT` without one.
    points: Vec<u32>,
}

/// Point with the column and row of its pixel.
pub(crate) type PlacedPoint<'a> = ([i32; 2], &'a Point);

impl DepthWindow {
    /// Window around points; `None` without points.
    pub(crate) fn new(placed: &[PlacedPoint<'_>]) -> Option<Self> {
        let bound = |pick: fn(i32, i32) -> i32, start: i32| -> [i32; 2] {
            [0, 1].map(|axis| placed.iter().map(|(p, _)| p[axis]).fold(start, pick))
        };
        let (first, last) = (bound(i32::min, i32::MAX), bound(i32::max, i32::MIN));
        if placed.is_empty() {
            return None;
        }
        let size = [0, 1].map(|axis| last[axis] - first[axis] + 1);
        let mut window = Self {
            first,
            size,
            points: vec![NO_POINT; (size[0] * size[1]) as usize],
        };
        for (index, ([column, row], point)) in placed.iter().enumerate() {
            let at = ((row - first[1]) * size[0] + column - first[0]) as usize;
            let present = placed.get(window.points[at] as usize);
            if present.is_none_or(|(_, present)| point.z < present.z) {
                window.points[at] = index as u32;
            }
        }
        Some(window)
    }

    /// Index of the point at a column and row of the image.
    #[inline]
    pub(crate) fn point_at(&self, column: i32, row: i32) -> Option<usize> {
        let index = self.points[self.place(column, row)?];
        (index != NO_POINT).then_some(index as usize)
    }

    #[inline]
    fn place(&self, column: i32, row: i32) -> Option<usize> {
        let (x, y) = (column - self.first[0], row - self.first[1]);
        let is_inside = x >= 0 && y >= 0 && x < self.size[0] && y < self.size[1];
        is_inside.then_some((y * self.size[0] + x) as usize)
    }

    /// Distance of each point's pixel from the border of the object or a depth step, up to a
    /// maximum; 0 for a border.
    pub(crate) fn border_distances_px(&self, placed: &[PlacedPoint<'_>]) -> Vec<u8> {
        let mut distances = vec![BORDER_DISTANCE_MAX_PX; placed.len()];
        for (index, ([column, row], point)) in placed.iter().enumerate() {
            let is_step = |[dx, dy]: [i32; 2]| {
                let other = self.point_at(column + dx, row + dy);
                other.is_none_or(|other| (placed[other].1.z - point.z).abs() > STEP_SHARE * point.z)
            };
            if AROUND.into_iter().any(is_step) {
                distances[index] = 0;
            }
        }
        for distance in 1..BORDER_DISTANCE_MAX_PX {
            for (index, ([column, row], _)) in placed.iter().enumerate() {
                let is_next = |[dx, dy]: [i32; 2]| {
                    let other = self.point_at(column + dx, row + dy);
                    other.is_some_and(|other| distances[other] == distance - 1)
                };
                if distances[index] > distance && AROUND.into_iter().any(is_next) {
                    distances[index] = distance;
                }
            }
        }
        distances
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Square of 9 by 9 pixels, whose right third is farther away.
    fn square() -> Vec<([i32; 2], Point)> {
        let point = |column: i32| Point {
            z: if column < 6 { 0.8 } else { 0.9 },
            ..Point::default()
        };
        (0..81)
            .map(|i| ([i % 9 + 20, i / 9 + 30], point(i % 9)))
            .collect()
    }

    #[test]
    fn borders_are_where_the_object_ends_and_where_the_depth_steps() {
        let square = square();
        let placed: Vec<PlacedPoint<'_>> = square.iter().map(|(p, point)| (*p, point)).collect();
        let window = DepthWindow::new(&placed).unwrap();
        let distances = window.border_distances_px(&placed);
        let at = |x: i32, y: i32| distances[window.point_at(20 + x, 30 + y).unwrap()];
        assert_eq!(
            [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|x| at(x, 4)),
            [0, 1, 2, 2, 1, 0, 0, 1, 0]
        );
        assert_eq!(at(2, 0), 0);
        assert_eq!(window.point_at(19, 30), None);
    }

    #[test]
    fn the_nearer_of_two_points_in_a_pixel_counts() {
        let [near, far] = [0.5, 0.7].map(|z| Point {
            z,
            ..Point::default()
        });
        let window = DepthWindow::new(&[([3, 3], &far), ([3, 3], &near)]).unwrap();
        assert_eq!(window.point_at(3, 3), Some(1));
        assert!(DepthWindow::new(&[]).is_none());
    }
}
