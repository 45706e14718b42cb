//! Table surface map: grid of the cells that belong to the table. Gaps through which
//! farther points are visible are not table; behind what hides it the table goes on.

mod cell_grid;
mod gaps;
mod occluded_extent;
mod ray_evidence;

use crate::outline::Outline;
use crate::samples::Samples;
use crate::table::Table;
use cell_grid::CellGrid;
use gaps::TableGaps;
use geometry::ConvexPolygon;
use nalgebra::{Point2, Vector2};
use occluded_extent::{EXTENT_MAX_M, OccludedExtent};
use ray_evidence::RayEvidence;

/// Margin by which the polygon is grown, metres: the visible table ends half a sample
/// before its rim. Chosen.
const POLYGON_MARGIN_M: f64 = 0.01;

/// Greatest overhang of an object's points beyond the table, metres: objects at the rim
/// occlude it and extend over it. Chosen.
const OVERHANG_M: f64 = 0.10;

/// Distances beyond a side of the outline at which free space makes it a rim, cells.
const BEYOND_CELLS: [f64; 3] = [1.5, 2.5, 3.5];

/// Least share of a side with free space beyond it for a rim. Chosen.
const FREE_SHARE_MIN: f64 = 0.5;

/// Table surface map: cells in the frame of the table. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct TableSurface {
    grid: CellGrid,
    is_table: Vec<bool>,
    is_near: Vec<bool>,
    rays: RayEvidence,
    gaps: TableGaps,
    extent: OccludedExtent,
    scratch: Vec<bool>,
}

impl TableSurface {
    /// Fill the map of a table and mark the rim sides of its outline, which comes as its
    /// convex hull: the cells of the polygon without gaps, and the occluded extent.
    pub(crate) fn refill(&mut self, table: &mut Table, samples: &Samples) {
        self.grid = CellGrid::around(&table.polygon, OVERHANG_M.max(EXTENT_MAX_M));
        self.fill_polygon(&table.polygon);
        self.rays.refill(&self.grid, table, samples);
        self.gaps.cut(&self.grid, &self.rays, &mut self.is_table);
        self.mark_rims(&mut table.outline);
        self.extent
            .grow(&self.grid, &self.rays, &table.outline, &mut self.is_table);
        let reach = self.grid.n_cells(OVERHANG_M);
        self.grid
            .dilate(&self.is_table, reach, &mut self.scratch, &mut self.is_near);
    }

    /// Fill the map from a polygon alone, without gaps.
    pub(crate) fn refill_from_polygon(&mut self, polygon: &ConvexPolygon) {
        self.grid = CellGrid::around(polygon, OVERHANG_M);
        self.fill_polygon(polygon);
        self.gaps.clear();
        self.extent.clear();
        self.is_near.clear();
        self.is_near.extend_from_slice(&self.is_table);
    }

    /// `true` when a point is on the table; coordinates in the table's frame, metres.
    #[inline]
    pub(crate) fn is_table(&self, u: f32, v: f32) -> bool {
        self.grid
            .cell_of(u, v)
            .is_some_and(|cell| self.is_table[cell])
    }

    /// `true` when a point is on the table or within the overhang of an object.
    #[inline]
    pub(crate) fn is_near(&self, u: f32, v: f32) -> bool {
        self.grid
            .cell_of(u, v)
            .is_some_and(|cell| self.is_near[cell])
    }

    /// Index of the cell of a point, for [`is_near_cell`](Self::is_near_cell); vectorised by
    /// the compiler.
    #[inline]
    pub(crate) fn cell_index(&self, u: f32, v: f32) -> u32 {
        self.grid.index_of(u, v)
    }

    /// `true` when a cell is table or within the overhang of an object; `false` outside of the
    /// grid.
    #[inline]
    pub(crate) fn is_near_cell(&self, cell: u32) -> bool {
        self.is_near.get(cell as usize) == Some(&true)
    }

    /// `true` when the table is not its polygon: it has gaps, or goes on behind objects.
    pub(crate) fn differs_from_polygon(&self) -> bool {
        self.gaps.is_any() || self.extent.is_any()
    }

    /// Width and height of the grid, cells.
    pub(crate) fn size(&self) -> [usize; 2] {
        [self.grid.width, self.grid.height]
    }

    /// `true` when a cell, counted from 0, is table; `false` outside of the grid.
    pub(crate) fn is_table_cell(&self, column: isize, row: isize) -> bool {
        let CellGrid { width, height, .. } = self.grid;
        let inside = (0..width as isize).contains(&column) && (0..height as isize).contains(&row);
        inside && self.is_table[row as usize * width + column as usize]
    }

    /// Corner between four cells, table's frame.
    pub(crate) fn corner(&self, column: usize, row: usize) -> Point2<f64> {
        self.grid.corner(column, row)
    }

    /// Mark the sides of an outline beyond which free space is visible. A side where an
    /// object hides the rest of the table, or where the view ends, is no rim.
    pub(crate) fn mark_rims(&self, outline: &mut Outline) {
        let Outline { corners, is_rim } = outline;
        is_rim.clear();
        for (i, a) in corners.iter().enumerate() {
            is_rim.push(self.is_free_beyond(a, &corners[(i + 1) % corners.len()]));
        }
    }

    /// `true` when free space is visible beyond most of the side from `a` to `b`, which has
    /// the table on its left.
    fn is_free_beyond(&self, a: &Point2<f64>, b: &Point2<f64>) -> bool {
        let along = b - a;
        let length_m = along.norm();
        let cell_m = self.grid.cell_m();
        let outward = Vector2::new(along.y, -along.x) * (cell_m / length_m.max(1e-9));
        let n_steps = (length_m / cell_m).ceil().max(1.0) as usize;
        let is_free = |step: &usize| {
            let on_side = a + along * ((*step as f64 + 0.5) / n_steps as f64);
            BEYOND_CELLS.into_iter().any(|n_cells| {
                let place = on_side + n_cells * outward;
                let cell = self.grid.cell_of(place.x as f32, place.y as f32);
                cell.is_some_and(|cell| self.rays.n_through[cell] > 0)
            })
        };
        let n_free = (0..n_steps).filter(is_free).count();
        n_free as f64 >= FREE_SHARE_MIN * n_steps as f64
    }

    /// Mark the cells with their centre inside the polygon or its margin.
    fn fill_polygon(&mut self, polygon: &ConvexPolygon) {
        let CellGrid { width, height, .. } = self.grid;
        let half_m = 0.5 * self.grid.cell_m();
        self.is_table.clear();
        self.is_table.resize(self.grid.len(), false);
        for row in 0..height {
            let v = self.corner(0, row).y + half_m;
            let [from, to] = scanline_interval(polygon.corners(), v, POLYGON_MARGIN_M);
            for column in 0..width {
                let u = self.corner(column, row).x + half_m;
                self.is_table[row * width + column] = (from..=to).contains(&u);
            }
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
    use crate::table::{SurfaceRole, TableChoice};
    use geometry::Plane;
    use nalgebra::{Point3, Vector3};
    use proptest::prelude::*;
    use sensor_noise::DepthNoise;

    fn table(corners: &mut [Point2<f64>]) -> Table {
        let plane = Plane::through(&Point3::new(0.0, 0.0, 1.0), -Vector3::z_axis());
        Table {
            plane,
            plane_by_image: plane,
            table_from_camera: plane.plane_from_source(),
            polygon: ConvexPolygon::convex_hull_of(corners),
            outline: Outline::default(),
            n_samples: 0,
            choice: TableChoice::Only,
            role: SurfaceRole::Table,
            depth_noise: DepthNoise::default(),
            noise_ratio: 1.0,
        }
    }

    proptest! {
        #[test]
        fn cells_agree_with_the_polygon_away_from_its_border(
            mut corners in prop::collection::vec((-1.0..1.0, -1.0..1.0).prop_map(|(x, y)| Point2::new(x, y)), 3..20),
            probes in prop::collection::vec((-1.2..1.2, -1.2..1.2), 50),
        ) {
            let mut table = table(&mut corners);
            prop_assume!(table.polygon.corners().len() >= 3 && table.polygon.area_m2() > 0.05);
            let mut surface = TableSurface::default();
            surface.refill(&mut table, &Samples::default());
            prop_assert!(!surface.differs_from_polygon());
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
    }

    #[test]
    fn empty_polygon_has_no_cells() {
        let mut surface = TableSurface::default();
        surface.refill(&mut table(&mut []), &Samples::default());
        assert!(!surface.is_near(0.0, 0.0) && !surface.is_near(f32::NAN, 0.0));
    }
}
