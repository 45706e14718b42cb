//! Contour tracing of the table's cells into an outline polygon.

use crate::outline::{Outline, distance_m};
use crate::table_surface::TableSurface;
use nalgebra::Point2;

/// Tolerance of the polygon simplification, metres. Chosen.
const TOLERANCE_M: f64 = 0.03;

/// Contour tracer of the table's cells, with its buffers.
#[derive(Debug, Default)]
pub(crate) struct OutlineTracer {
    corners: Vec<Point2<f64>>,
    kept: Vec<u32>,
    open: Vec<[u32; 2]>,
}

impl OutlineTracer {
    /// Trace the border of the table's cells into `outline`, with its rim sides marked.
    pub(crate) fn trace(&mut self, surface: &TableSurface, outline: &mut Outline) {
        self.trace_border(surface);
        self.simplify();
        outline.corners.clear();
        let corners = self.kept.iter().map(|&i| self.corners[i as usize]);
        outline.corners.extend(corners);
        surface.mark_rims(outline);
    }

    /// Boundary following: walk around the table's cells, which stay on the left, from the
    /// first cell back to it, and record the turning points.
    fn trace_border(&mut self, surface: &TableSurface) {
        const STEPS: [[isize; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
        self.corners.clear();
        let [width, height] = surface.size();
        let first = (0..width * height)
            .map(|cell| (cell % width, cell / width))
            .find(|&(column, row)| surface.is_table_cell(column as isize, row as isize));
        let Some((column, row)) = first else { return };
        let start = [column as isize, row as isize];
        let (mut at, mut heading) = (start, 0);
        loop {
            at = [at[0] + STEPS[heading][0], at[1] + STEPS[heading][1]];
            // Cells ahead, to the left and to the right of the heading.
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

    /// Polygon simplification (Douglas and Peucker 1973).
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
