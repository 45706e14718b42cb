//! Table surface map: grid of the cells that belong to the table, without gaps through
//! which farther points are visible.

use crate::affine_form::AffineForm;
use crate::samples::Samples;
use crate::table::Table;
use geometry::ConvexPolygon;
use nalgebra::Point2;

/// Cell size of the surface map, metres; a larger table gets larger cells. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const CELL_M: f64 = 0.02;

/// Greatest number of cells per side of the table surface map; a larger table has larger
/// cells.
const CELLS_MAX: usize = 256;

/// Margin by which the polygon is grown, metres: the visible table ends half a sample
/// before its rim. Chosen; sensitivity: see `tabula-lab sweep`.
const POLYGON_MARGIN_M: f64 = 0.01;

/// Greatest overhang of an object's points beyond the table, metres: objects at the rim
/// occlude it and extend over it. Chosen; sensitivity: see `tabula-lab sweep`.
const OVERHANG_M: f64 = 0.10;

/// Least depth below the plane of a sample that is seen through it, metres. Chosen;
/// sensitivity: see `tabula-lab sweep`.
const SEEN_THROUGH_M: f32 = 0.03;

/// Greatest distance from the plane of a sample level with the table, metres. Chosen;
/// sensitivity: see `tabula-lab sweep`.
const LEVEL_M: f32 = 0.015;

/// Greatest depth below the plane at which a surface counts as passing through it, metres.
/// Chosen; sensitivity: see `tabula-lab sweep`.
const BELOW_M: f32 = 0.10;

/// Least number of samples seen through a cell that proves a gap. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const THROUGH_SAMPLES_MIN: u8 = 2;

/// Least number of samples right below and right above a cell that prove an object from the
/// floor passing through it. Chosen; sensitivity: see `tabula-lab sweep`.
const PIERCING_SAMPLES_MIN: i32 = 2;

/// Least total area of gaps, square metres; smaller ones are noise. Chosen; sensitivity:
/// see `tabula-lab sweep`.
const GAP_AREA_MIN_M2: f64 = 0.01;

/// Table surface map: cells in the frame of the table. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct TableSurface {
    u_min: f32,
    v_min: f32,
    cells_per_m: f32,
    pub(crate) width: usize,
    pub(crate) height: usize,
    is_table: Vec<bool>,
    is_near: Vec<bool>,
    /// Per cell: number of samples seen through it.
    n_through: Vec<u8>,
    /// Per cell: number of samples level with it, minus those above it.
    n_level: Vec<i32>,
    /// Per cell: number of samples right below it.
    n_below: Vec<i32>,
    is_gap: Vec<bool>,
    front: Vec<u32>,
    scratch: Vec<bool>,
}

impl TableSurface {
    /// Fill the map of a table: the cells of its polygon without the gaps through which
    /// something farther is visible, as in the corner of an L-shaped table.
    pub(crate) fn refill(&mut self, table: &Table, samples: &Samples) {
        self.fit_grid(&table.polygon);
        self.fill_polygon(&table.polygon);
        self.count_rays(table, samples);
        self.find_gaps();
        self.cut_gaps();
        dilate(
            &self.is_table,
            (self.width, self.height),
            (OVERHANG_M * f64::from(self.cells_per_m)).ceil() as usize,
            &mut self.scratch,
            &mut self.is_near,
        );
    }

    /// Fill the map from a polygon alone, without gaps.
    pub(crate) fn refill_from_polygon(&mut self, polygon: &ConvexPolygon) {
        self.fit_grid(polygon);
        self.fill_polygon(polygon);
        self.is_gap.clear();
        self.is_near.clear();
        self.is_near.extend_from_slice(&self.is_table);
    }

    /// `true` when a point is on the table; coordinates in the table's frame, metres.
    #[inline]
    pub(crate) fn is_table(&self, u: f32, v: f32) -> bool {
        self.cell_of(u, v).is_some_and(|cell| self.is_table[cell])
    }

    /// `true` when a point is on the table or within the overhang of an object.
    #[inline]
    pub(crate) fn is_near(&self, u: f32, v: f32) -> bool {
        self.cell_of(u, v).is_some_and(|cell| self.is_near[cell])
    }

    /// `true` when the table has gaps inside its polygon.
    pub(crate) fn has_gaps(&self) -> bool {
        self.is_gap.contains(&true)
    }

    /// `true` when a cell, counted from 0, is table; `false` outside of the grid.
    pub(crate) fn is_table_cell(&self, column: isize, row: isize) -> bool {
        let inside =
            (0..self.width as isize).contains(&column) && (0..self.height as isize).contains(&row);
        inside && self.is_table[row as usize * self.width + column as usize]
    }

    /// Corner between four cells, table's frame.
    pub(crate) fn corner(&self, column: usize, row: usize) -> Point2<f64> {
        let cell_m = 1.0 / f64::from(self.cells_per_m);
        Point2::new(
            f64::from(self.u_min) + column as f64 * cell_m,
            f64::from(self.v_min) + row as f64 * cell_m,
        )
    }

    #[inline]
    #[expect(
        clippy::needless_bitwise_bool,
        reason = "unpredictable branches cost more than comparisons"
    )]
    fn cell_of(&self, u: f32, v: f32) -> Option<usize> {
        let column = (u - self.u_min) * self.cells_per_m;
        let row = (v - self.v_min) * self.cells_per_m;
        let inside = (column >= 0.0)
            & (row >= 0.0)
            & (column < self.width as f32)
            & (row < self.height as f32);
        inside.then(|| row as usize * self.width + column as usize)
    }

    /// Fit the grid to the polygon with the overhang around it.
    fn fit_grid(&mut self, polygon: &ConvexPolygon) {
        let around = OVERHANG_M + 2.0 * CELL_M;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in polygon.corners() {
            for (i, at) in [corner.x, corner.y].into_iter().enumerate() {
                (low[i], high[i]) = (low[i].min(at - around), high[i].max(at + around));
            }
        }
        let extent_m = (high[0] - low[0]).max(high[1] - low[1]).max(CELL_M);
        let cell_m = CELL_M.max(extent_m / (CELLS_MAX - 1) as f64);
        let n_cells = |i: usize| {
            let n = ((high[i] - low[i]) / cell_m).ceil();
            if n.is_finite() {
                (n as usize).min(CELLS_MAX)
            } else {
                0
            }
        };
        (self.u_min, self.v_min) = (low[0] as f32, low[1] as f32);
        self.cells_per_m = (1.0 / cell_m) as f32;
        (self.width, self.height) = (n_cells(0), n_cells(1));
    }

    /// Mark the cells with their centre inside the polygon or its margin.
    fn fill_polygon(&mut self, polygon: &ConvexPolygon) {
        self.is_table.clear();
        self.is_table.resize(self.width * self.height, false);
        for row in 0..self.height {
            let v = self.corner(0, row).y + 0.5 / f64::from(self.cells_per_m);
            let [from, to] = scanline_interval(polygon.corners(), v, POLYGON_MARGIN_M);
            for column in 0..self.width {
                let u = self.corner(column, row).x + 0.5 / f64::from(self.cells_per_m);
                self.is_table[row * self.width + column] = (from..=to).contains(&u);
            }
        }
    }

    /// Ray counting: per cell, the samples seen through it, level with it, above it and
    /// below it.
    fn count_rays(&mut self, table: &Table, samples: &Samples) {
        self.n_through.clear();
        self.n_through.resize(self.is_table.len(), 0);
        for counts in [&mut self.n_level, &mut self.n_below] {
            counts.clear();
            counts.resize(self.is_table.len(), 0);
        }
        let [u, v, height] = AffineForm::coordinates_of(&table.table_from_camera);
        let camera_height = height.at(0.0, 0.0, 0.0);
        for sample in (0..samples.len()).filter(|&sample| samples.depth(sample) > 0.0) {
            let above = samples.coordinate(&height, sample);
            if above >= -BELOW_M {
                let cell = self.cell_of(
                    samples.coordinate(&u, sample),
                    samples.coordinate(&v, sample),
                );
                if let Some(cell) = cell {
                    self.n_level[cell] += i32::from(above.abs() <= LEVEL_M);
                    self.n_level[cell] -= i32::from(above > LEVEL_M);
                    self.n_below[cell] += i32::from(above < -SEEN_THROUGH_M);
                }
            }
            if above < -SEEN_THROUGH_M {
                // Intersection of the plane with the ray from the camera to the sample.
                let share = camera_height / (camera_height - above);
                let at = |axis: &AffineForm| {
                    let from = axis.at(0.0, 0.0, 0.0);
                    from + share * (samples.coordinate(axis, sample) - from)
                };
                if let Some(cell) = self.cell_of(at(&u), at(&v)) {
                    self.n_through[cell] = self.n_through[cell].saturating_add(1);
                }
            }
        }
    }

    /// Find the gaps of the table by morphological opening of the see-through cells; too
    /// small a total area is noise.
    fn find_gaps(&mut self) {
        let size = (self.width, self.height);
        let not_through = self.n_through.iter().map(|&n| n < THROUGH_SAMPLES_MIN);
        self.is_near.clear();
        self.is_near.extend(not_through);
        // Opening: dilate the complement by a cell, then dilate the remaining gaps back.
        dilate(&self.is_near, size, 1, &mut self.scratch, &mut self.is_gap);
        self.is_gap.iter_mut().for_each(|cell| *cell = !*cell);
        dilate(&self.is_gap, size, 1, &mut self.scratch, &mut self.is_near);
        std::mem::swap(&mut self.is_near, &mut self.is_gap);
        for (is_gap, is_table) in self.is_gap.iter_mut().zip(&self.is_table) {
            *is_gap &= is_table;
        }
        let n_gaps = self.is_gap.iter().filter(|&&is_gap| is_gap).count();
        let cell_m2 = f64::from(self.cells_per_m).powi(-2);
        if (n_gaps as f64) * cell_m2 < GAP_AREA_MIN_M2 {
            self.is_gap.fill(false);
        }
    }

    /// Remove the gaps from the table, with the cells occluded by objects that reach up
    /// through a gap.
    fn cut_gaps(&mut self) {
        if self.has_gaps() {
            self.grow_gaps();
        }
        for (is_table, is_gap) in self.is_table.iter_mut().zip(&self.is_gap) {
            *is_table &= !is_gap;
        }
    }

    /// Assign each occluded cell to the nearest known one: visible table or an object
    /// passing through.
    fn grow_gaps(&mut self) {
        let Self {
            front,
            is_near: is_known,
            is_gap,
            ..
        } = self;
        front.clear();
        is_known.clear();
        for (cell, is_gap) in is_gap.iter_mut().enumerate() {
            let (is_table, n_level) = (self.is_table[cell], self.n_level[cell]);
            let is_pierced = is_table
                && n_level <= -PIERCING_SAMPLES_MIN
                && self.n_below[cell] >= PIERCING_SAMPLES_MIN;
            let is_source = is_pierced || is_table && n_level > 0 && !*is_gap;
            *is_gap |= is_pierced;
            is_known.push(is_source || *is_gap || !is_table);
            if is_source {
                front.push(cell as u32);
            }
        }
        let mut next = 0;
        while let Some(&cell) = front.get(next) {
            next += 1;
            let cell = cell as usize;
            // The cells around the table are not table, except with very large cells.
            for step in [-1, 1, -(self.width as isize), self.width as isize] {
                let near = cell.wrapping_add_signed(step);
                if is_known.get(near) == Some(&false) {
                    is_known[near] = true;
                    is_gap[near] = is_gap[cell];
                    front.push(near as u32);
                }
            }
        }
    }
}

/// Morphological dilation with a square of `reach` columns and rows.
fn dilate(
    marked: &[bool],
    (width, height): (usize, usize),
    reach: usize,
    scratch: &mut Vec<bool>,
    dilated: &mut Vec<bool>,
) {
    for cells in [&mut *scratch, &mut *dilated] {
        cells.clear();
        cells.resize(marked.len(), false);
    }
    for row in 0..height {
        let line = row * width..(row + 1) * width;
        dilate_line(&marked[line.clone()], 1, reach, &mut scratch[line]);
    }
    for column in 0..width.min(marked.len()) {
        dilate_line(&scratch[column..], width, reach, &mut dilated[column..]);
    }
}

/// One-dimensional dilation of a line with its cells `stride` apart.
fn dilate_line(marked: &[bool], stride: usize, reach: usize, dilate_line: &mut [bool]) {
    let n = marked.len().div_ceil(stride);
    let mut until = 0;
    for i in 0..n + reach {
        if i < n && marked[i * stride] {
            until = i + 2 * reach + 1;
        }
        if i < until && i >= reach {
            dilate_line[(i - reach) * stride] = true;
        }
    }
}

/// Scanline interval of a convex polygon grown by a margin at ordinate `v`; empty outside.
fn scanline_interval(corners: &[Point2<f64>], v: f64, margin_m: f64) -> [f64; 2] {
    const EMPTY: [f64; 2] = [1.0, 0.0];
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let along = b - a;
        let length = along.norm();
        // Inside is where along.x * (v - a.y) - along.y * (u - a.x) >= -margin * length.
        let left = along.x * (v - a.y) + margin_m * length;
        if along.y > 1e-9 * length {
            high = high.min(a.x + left / along.y);
        } else if along.y < -1e-9 * length {
            low = low.max(a.x + left / along.y);
        } else if left < 0.0 {
            return EMPTY;
        }
    }
    if low <= high { [low, high] } else { EMPTY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outline::Outline;
    use crate::table::TableChoice;
    use geometry::Plane;
    use nalgebra::{Point3, Vector3};
    use proptest::prelude::*;

    fn table(corners: &mut [Point2<f64>]) -> Table {
        let plane = Plane::through(&Point3::new(0.0, 0.0, 1.0), -Vector3::z_axis());
        Table {
            plane,
            table_from_camera: plane.plane_from_source(),
            polygon: ConvexPolygon::convex_hull_of(corners),
            outline: Outline::default(),
            n_samples: 0,
            choice: TableChoice::Only,
        }
    }

    proptest! {
        #[test]
        fn cells_agree_with_the_polygon_away_from_its_border(
            mut corners in prop::collection::vec((-1.0..1.0, -1.0..1.0).prop_map(|(x, y)| Point2::new(x, y)), 3..20),
            probes in prop::collection::vec((-1.2..1.2, -1.2..1.2), 50),
        ) {
            let table = table(&mut corners);
            prop_assume!(table.polygon.corners().len() >= 3 && table.polygon.area_m2() > 0.05);
            let mut surface = TableSurface::default();
            surface.refill(&table, &Samples::default());
            prop_assert!(!surface.has_gaps());
            let ends = table.polygon.corners().iter().map(|corner| corner.y);
            let (low, high) = ends.fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
            for (u, v) in probes {
                let (u, v): (f64, f64) = (u, v);
                let inner = table.polygon.signed_distance_m(&Point2::new(u, v));
                // A pointed corner is cut off at the margin before its tip.
                let before_end = (v - low).min(high - v) > 0.03;
                if inner > 0.03 {
                    prop_assert!(surface.is_table(u as f32, v as f32) && surface.is_near(u as f32, v as f32));
                } else if inner < -0.05 && before_end {
                    prop_assert!(!surface.is_table(u as f32, v as f32));
                }
            }
        }

        #[test]
        fn dilation_matches_brute_force(
            marked in prop::collection::vec(prop::bool::weighted(0.1), 12 * 9), reach in 0..4_usize,
        ) {
            let (mut scratch, mut dilated) = (Vec::new(), Vec::new());
            dilate(&marked, (12, 9), reach, &mut scratch, &mut dilated);
            for (i, &is_marked) in dilated.iter().enumerate() {
                let near = |&other: &usize| {
                    (i % 12).abs_diff(other % 12) <= reach && (i / 12).abs_diff(other / 12) <= reach
                };
                let expected = (0..marked.len()).filter(near).any(|other| marked[other]);
                prop_assert_eq!(is_marked, expected);
            }
        }
    }

    #[test]
    fn empty_polygon_has_no_cells() {
        let mut surface = TableSurface::default();
        surface.refill(&table(&mut []), &Samples::default());
        assert!(!surface.is_near(0.0, 0.0) && !surface.is_near(f32::NAN, 0.0));
    }
}
