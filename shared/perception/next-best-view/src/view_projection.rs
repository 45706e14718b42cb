//! Projection of a virtual view: orthographic, or that of a pinhole camera.

use crate::error::Error;
use crate::planning_scene::PlanningScene;
use crate::virtual_view::RenderConfig;
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::Vector3;
use value_range::check_range;

/// Greatest number of cells along a side of a view.
pub(crate) const N_CELLS_MAX: usize = 2048;

/// Steps of the quantised depth, 15 bits; the last one stands for nothing.
pub(crate) const DEPTH_STEPS: f32 = 32_766.0;

/// Projection of a virtual view onto its grid of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ViewProjection {
    /// Parallel to the optical axis, onto square cells; the grid encloses the whole scene in front
    /// of the camera (Kasaei et al. 2018).
    Orthographic {
        /// Side of a cell, metres; 0.5 mm to 10 cm. At least the spacing of the models.
        cell_m: f64,
    },
    /// Central, onto the pixels of a camera. Choose a coarse one: the distance of neighbouring
    /// points must not exceed the width that the splats close.
    Perspective(PinholeCamera),
}

impl Default for ViewProjection {
    /// Orthographic with cells of 3 mm.
    fn default() -> Self {
        Self::Orthographic { cell_m: 0.003 }
    }
}

impl ViewProjection {
    /// Checks the settings of the projection.
    pub(crate) fn check(&self) -> Result<(), Error> {
        match self {
            Self::Orthographic { cell_m } => Ok(check_range("cell_m", *cell_m, 0.0005, 0.1)?),
            Self::Perspective(camera) => Ok(camera.validated().map(|_| ())?),
        }
    }
}

/// Grid of cells with a margin on each side.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct CellGrid {
    /// Cells without the margins.
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) margin: usize,
}

impl CellGrid {
    /// Cells of a row with its margins.
    pub(crate) fn stride(&self) -> usize {
        self.width + 2 * self.margin
    }

    /// Rows with the margins.
    pub(crate) fn n_rows(&self) -> usize {
        self.height + 2 * self.margin
    }

    /// Index of a cell among those with margins.
    pub(crate) fn index(&self, column: usize, row: usize) -> Option<usize> {
        let is_inside = column < self.width && row < self.height;
        is_inside.then(|| (row + self.margin) * self.stride() + column + self.margin)
    }
}

/// Mapping of the points of a scene to cells and quantised depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CellMapping {
    /// Rows of the affine map to column and row (orthographic, in cells with margins) or to x and
    /// y in the camera (perspective, metres), and to depth in steps.
    pub(crate) rows: [[f32; 4]; 3],
    pub(crate) grid: CellGrid,
    /// Depth of step 0, and of one step, metres.
    pub(crate) first_m: f32,
    pub(crate) step_m: f32,
    /// Focal lengths and principal point in cells with margins; `None` for orthographic.
    pub(crate) pinhole: Option<[f32; 4]>,
    /// Place of the cell without margins at column 0 and row 0, metres (orthographic).
    pub(crate) origin_m: [f32; 2],
    pub(crate) cell_m: f32,
}

impl CellMapping {
    /// Mapping of a scene for a camera. `None` if nothing is in front of the near clip.
    ///
    /// # Errors
    /// A scene too large for the cells.
    pub(crate) fn new(
        scene: &PlanningScene,
        world_from_camera: &RigidTransform,
        config: &RenderConfig,
    ) -> Result<Option<Self>, Error> {
        let camera_from_world = world_from_camera.inverse();
        let middle = camera_from_world * scene.middle();
        let rotation = camera_from_world.rotation.to_rotation_matrix();
        let affine: [[f64; 4]; 3] = std::array::from_fn(|axis| {
            let row = rotation.matrix().row(axis);
            [row[0], row[1], row[2], middle[axis]]
        });
        let bounds = affine.map(|row| bounds_of(&row, &scene.bounds));
        let near_m = f64::from(config.near_m);
        let [first_m, last_m] = [bounds[2][0].max(near_m), bounds[2][1]];
        if scene.n_points() == 0 || last_m < near_m {
            return Ok(None);
        }
        let margin = config.margin();
        let step_m = ((last_m - first_m) / f64::from(DEPTH_STEPS - 1.0)).max(1e-7);
        let mut mapping = Self {
            rows: [[0.0; 4]; 3],
            grid: CellGrid::default(),
            first_m: first_m as f32,
            step_m: step_m as f32,
            pinhole: None,
            origin_m: [0.0; 2],
            cell_m: 1.0,
        };
        mapping.rows[2] = scaled(&affine[2], step_m, first_m);
        match config.projection {
            ViewProjection::Orthographic { cell_m } => {
                mapping.cell_m = cell_m as f32;
                mapping.grid = grid_of(&bounds, cell_m, margin)?;
                for axis in 0..2 {
                    mapping.origin_m[axis] = bounds[axis][0] as f32;
                    let first = bounds[axis][0] - margin as f64 * cell_m;
                    mapping.rows[axis] = scaled(&affine[axis], cell_m, first);
                }
            }
            ViewProjection::Perspective(camera) => {
                mapping.grid = CellGrid {
                    width: camera.width as usize,
                    height: camera.height as usize,
                    margin,
                };
                let margin = margin as f64;
                let pinhole = [camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px];
                mapping.pinhole = Some([
                    pinhole[0] as f32,
                    pinhole[1] as f32,
                    (pinhole[2] + margin) as f32,
                    (pinhole[3] + margin) as f32,
                ]);
                for (row, exact) in mapping.rows.iter_mut().zip(&affine).take(2) {
                    *row = exact.map(|value| value as f32);
                }
            }
        }
        Ok(Some(mapping))
    }

    /// Depth of a number of steps, metres.
    pub(crate) fn depth_m(&self, steps: i32) -> f32 {
        self.first_m + steps as f32 * self.step_m
    }

    /// Area of a cell at a depth, square metres.
    pub(crate) fn cell_area_m2(&self, depth_m: f32) -> f64 {
        match self.pinhole {
            None => f64::from(self.cell_m).powi(2),
            Some([fx_px, fy_px, ..]) => f64::from(depth_m * depth_m / (fx_px * fy_px)),
        }
    }

    /// Point of the middle of a cell without margins at a depth, camera frame, metres.
    pub(crate) fn position(&self, column: usize, row: usize, depth_m: f32) -> [f32; 3] {
        let cell = [column as f32, row as f32];
        match self.pinhole {
            None => {
                let place = |axis: usize| self.origin_m[axis] + cell[axis] * self.cell_m;
                [place(0), place(1), depth_m]
            }
            Some([fx, fy, cx, cy]) => {
                let margin = self.grid.margin as f32;
                let x = (cell[0] + margin - cx) / fx * depth_m;
                [x, (cell[1] + margin - cy) / fy * depth_m, depth_m]
            }
        }
    }
}

/// Affine row in units of `unit`, from `first` on.
fn scaled(row: &[f64; 4], unit: f64, first: f64) -> [f32; 4] {
    let [x, y, z, t] = row;
    [x / unit, y / unit, z / unit, (t - first) / unit].map(|value| value as f32)
}

/// Least and greatest value of an affine function over a box.
fn bounds_of(row: &[f64; 4], bounds: &[Vector3<f32>; 2]) -> [f64; 2] {
    let (mut low, mut high) = (row[3], row[3]);
    for axis in 0..3 {
        let ends = bounds.map(|end| row[axis] * f64::from(end[axis]));
        low += ends[0].min(ends[1]);
        high += ends[0].max(ends[1]);
    }
    [low, high]
}

fn grid_of(bounds: &[[f64; 2]; 3], cell_m: f64, margin: usize) -> Result<CellGrid, Error> {
    let extents = [bounds[0], bounds[1]].map(|[low, high]| high - low);
    let n_cells = extents.map(|extent| (extent / cell_m).ceil() + 2.0);
    // Written so that a scene with an infinite extent is refused, too.
    if !n_cells.iter().all(|n| *n <= N_CELLS_MAX as f64) {
        return Err(Error::SceneTooLarge {
            extent_m: extents[0].max(extents[1]),
            cell_m,
            max: N_CELLS_MAX,
        });
    }
    let [width, height] = n_cells.map(|n| n as usize);
    Ok(CellGrid {
        width,
        height,
        margin,
    })
}
