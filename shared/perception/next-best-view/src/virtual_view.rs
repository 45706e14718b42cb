//! Virtual view of a scene: label and depth of each cell, and the visible area of each object.

use crate::depth_buffer::{DepthBuffer, EMPTY, PointSlices, label_of, steps_of};
use crate::error::Error;
use crate::planning_scene::{PlanningScene, is_pose_finite};
use crate::view_projection::{CellGrid, CellMapping, ViewProjection};
use geometry::RigidTransform;
use point_cloud::{Point, Rgba};
use value_range::check_range;

/// Colours of the objects in a virtual cloud; those of the background and of the objects by turns.
const COLORS: [Rgba; 7] = [
    Rgba::opaque(150, 150, 150),
    Rgba::opaque(200, 60, 50),
    Rgba::opaque(60, 120, 200),
    Rgba::opaque(80, 170, 70),
    Rgba::opaque(220, 180, 50),
    Rgba::opaque(140, 80, 170),
    Rgba::opaque(60, 170, 170),
];

/// Settings of a virtual view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderConfig {
    /// Projection onto the cells.
    pub projection: ViewProjection,
    /// Radius of the splats, cells; 0 to 8. Gaps up to twice as wide are closed.
    pub splat_radius: usize,
    /// Depth behind the closed surface up to which a point keeps its own cell, metres; 0 to 0.1.
    pub tolerance_m: f32,
    /// Depth in front of which nothing is drawn, metres; 0.01 to 1.
    pub near_m: f32,
}

impl Default for RenderConfig {
    /// Orthographic cells of 3 mm, splats of 3x3 cells, a tolerance of 5 mm, a near clip of 5 cm.
    /// Chosen.
    fn default() -> Self {
        Self {
            projection: ViewProjection::default(),
            splat_radius: 1,
            tolerance_m: 0.005,
            near_m: 0.05,
        }
    }
}

impl RenderConfig {
    /// Checks the settings.
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.projection.check()?;
        check_range("splat_radius", self.splat_radius as f64, 0.0, 8.0)?;
        check_range("tolerance_m", self.tolerance_m.into(), 0.0, 0.1)?;
        Ok(check_range("near_m", self.near_m.into(), 0.01, 1.0)?)
    }

    /// Width of the margin around the image that closing needs, cells.
    pub(crate) fn margin(&self) -> usize {
        2 * self.splat_radius + 2
    }
}

/// Label of a cell of a virtual view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewLabel {
    /// Cell without any surface.
    Empty,
    /// Cell that shows the background.
    Background,
    /// Cell that shows an object: index into [`PlanningScene::ids`].
    Object(usize),
}

/// Virtual view with its buffers, reused from view to view.
#[derive(Debug, Clone, Default)]
pub struct VirtualView {
    buffer: DepthBuffer,
    mapping: Option<CellMapping>,
    /// Visible area of the background and of each object, square metres.
    areas_m2: Vec<f64>,
}

impl VirtualView {
    /// Renders a scene from a camera. Nothing is visible of a scene behind the camera.
    ///
    /// # Errors
    /// A setting outside its range, a pose that is not finite, or a scene too large for the cells.
    pub fn render(
        &mut self,
        scene: &PlanningScene,
        world_from_camera: &RigidTransform,
        config: &RenderConfig,
    ) -> Result<(), Error> {
        config.check()?;
        if !is_pose_finite(world_from_camera) {
            let what = "camera";
            return Err(Error::NotFinite { what, index: 0 });
        }
        self.areas_m2.clear();
        self.areas_m2.resize(scene.ids().len() + 1, 0.0);
        self.mapping = CellMapping::new(scene, world_from_camera, config)?;
        let Some(mapping) = self.mapping else {
            return Ok(());
        };
        self.buffer.clear(&mapping.grid);
        for (range, label) in &scene.ranges {
            let points = PointSlices {
                x: &scene.x[range.clone()],
                y: &scene.y[range.clone()],
                z: &scene.z[range.clone()],
            };
            self.buffer.draw(points, *label, &mapping);
        }
        let tolerance_steps = (config.tolerance_m / mapping.step_m).min(32_000.0) as i32;
        self.buffer
            .close(&mapping.grid, config.splat_radius, tolerance_steps);
        self.measure_areas(&mapping);
        Ok(())
    }

    fn measure_areas(&mut self, mapping: &CellMapping) {
        let (cells, areas_m2) = (self.buffer.squares(), &mut self.areas_m2);
        if mapping.pinhole.is_some() {
            for &cell in inner_rows(cells, &mapping.grid).flatten() {
                if cell != EMPTY {
                    let area_m2 = mapping.cell_area_m2(mapping.depth_m(steps_of(cell)));
                    if let Some(area) = areas_m2.get_mut(usize::from(label_of(cell))) {
                        *area += area_m2;
                    }
                }
            }
            return;
        }
        let cell_area_m2 = mapping.cell_area_m2(0.0);
        let mut add = |cell: i32, n: u32| {
            // The label of an empty cell is beyond all others.
            if let Some(area) = areas_m2.get_mut(usize::from(label_of(cell))) {
                *area += f64::from(n) * cell_area_m2;
            }
        };
        // Runs of one label: neighbouring cells mostly show the same surface.
        let (mut last, mut n) = (EMPTY, 0);
        for &cell in inner_rows(cells, &mapping.grid).flatten() {
            if label_of(cell) != label_of(last) {
                add(last, n);
                (last, n) = (cell, 0);
            }
            n += 1;
        }
        add(last, n);
    }

    /// Visible area of each object, in the order of [`PlanningScene::ids`], square metres.
    pub fn object_areas_m2(&self) -> &[f64] {
        self.areas_m2.get(1..).unwrap_or(&[])
    }

    /// Visible area of the background, square metres.
    pub fn background_area_m2(&self) -> f64 {
        self.areas_m2.first().copied().unwrap_or(0.0)
    }

    /// Columns and rows of the view; zeros when nothing is visible.
    pub fn size(&self) -> (usize, usize) {
        let grid = self.mapping.map(|mapping| mapping.grid).unwrap_or_default();
        (grid.width, grid.height)
    }

    /// Label of a cell; empty outside of the view.
    pub fn label(&self, column: usize, row: usize) -> ViewLabel {
        match self.cell(column, row) {
            None => ViewLabel::Empty,
            Some(cell) => match label_of(cell) {
                0 => ViewLabel::Background,
                label => ViewLabel::Object(usize::from(label) - 1),
            },
        }
    }

    /// Depth of a cell along the optical axis, metres; `None` for an empty one.
    pub fn depth_m(&self, column: usize, row: usize) -> Option<f32> {
        let cell = self.cell(column, row)?;
        Some(self.mapping?.depth_m(steps_of(cell)))
    }

    /// Area of a cell as seen, square metres; `None` for an empty one. For a perspective view it
    /// grows with the squared depth.
    pub fn cell_area_m2(&self, column: usize, row: usize) -> Option<f64> {
        let depth_m = self.depth_m(column, row)?;
        Some(self.mapping?.cell_area_m2(depth_m))
    }

    fn cell(&self, column: usize, row: usize) -> Option<i32> {
        let index = self.mapping?.grid.index(column, row)?;
        let cell = *self.buffer.cells().get(index)?;
        (cell != EMPTY).then_some(cell)
    }

    /// Virtual point cloud: the view as an organised cloud in the frame of its camera, row-major,
    /// of [`size`](Self::size). Empty cells have no depth. Neighbouring objects get different
    /// colours if their identities are neighbours, since hypotheses have none.
    pub fn write_cloud(&self, points: &mut Vec<Point>) {
        points.clear();
        let Some(mapping) = self.mapping else { return };
        for (row, cells) in inner_rows(self.buffer.cells(), &mapping.grid).enumerate() {
            points.extend(cells.iter().enumerate().map(|(column, &cell)| {
                if cell == EMPTY {
                    return Point::without_depth(Rgba::opaque(0, 0, 0));
                }
                let depth_m = mapping.depth_m(steps_of(cell));
                let [x, y, z] = mapping.position(column, row, depth_m);
                let color = color_of(label_of(cell));
                Point { x, y, z, color }
            }));
        }
    }
}

fn color_of(label: u16) -> Rgba {
    let turn = usize::from(label.saturating_sub(1)) % (COLORS.len() - 1) + 1;
    COLORS[if label == 0 { 0 } else { turn }]
}

/// Rows of the image without its margins.
fn inner_rows<'a>(cells: &'a [i32], grid: &CellGrid) -> impl Iterator<Item = &'a [i32]> {
    let (margin, width) = (grid.margin, grid.width);
    let rows = cells.chunks(grid.stride().max(1));
    rows.skip(margin)
        .take(grid.height)
        .filter_map(move |row| row.get(margin..margin + width))
}

#[cfg(test)]
mod tests;
