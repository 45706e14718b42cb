//! What does not move, drawn once.

use crate::image::Image;
use crate::shading::Radiance;
use crate::shadow_map::ShadowMap;
use crate::shadow_reach::{CellRectangle, ShadowReach};
use crate::visibility::{Extent, NO_FACE, Visibility};

/// Side of the blocks of pixels that are checked for new shadows together.
const TILE_PX: usize = 8;

/// The image of what does not move, and what is needed to draw over it.
#[derive(Debug)]
pub(crate) struct Background {
    pub(crate) image: Image,
    pub(crate) closeness: Vec<f32>,
    pub(crate) shadow: Vec<f32>,
    pub(crate) radiance: Vec<Radiance>,
    /// Share of the main light in each pixel, times 255; 0 where none arrives anyway.
    pub(crate) light: Vec<u8>,
    tiles: Vec<Tile>,
}

/// A block of pixels with light in it.
#[derive(Debug)]
struct Tile {
    column: usize,
    row: usize,
    cells: CellRectangle,
}

impl Background {
    pub(crate) fn new(image: Image) -> Self {
        let n_pixels = image.depth_m.len();
        Self {
            image,
            closeness: vec![0.0; n_pixels],
            shadow: Vec::new(),
            radiance: vec![Radiance::default(); n_pixels],
            light: vec![0; n_pixels],
            tiles: Vec::new(),
        }
    }

    /// Keeps a finished image and finds where shadows may fall later.
    pub(crate) fn keep(&mut self, image: &Image, visibility: &Visibility, shadow: &ShadowMap) {
        self.image.copy_span(image, 0..image.depth_m.len());
        self.closeness.clone_from(&visibility.closeness);
        self.shadow.clone_from(&shadow.closeness);
    }

    /// Finds the blocks of pixels in which a shadow would be seen.
    pub(crate) fn find_tiles(&mut self, rays: &Rays, shadow: &ShadowMap) {
        self.tiles.clear();
        let (width, height) = rays.size();
        for row in (0..height).step_by(TILE_PX) {
            for column in (0..width).step_by(TILE_PX) {
                let mut cells = CellRectangle::EMPTY;
                for (x, y) in pixels(column, row, (width, height)) {
                    let pixel = y * width + x;
                    if self.light[pixel] == 0 {
                        continue;
                    }
                    let point = rays.point(x, y, self.image.depth_m[pixel]);
                    if let Some(place) = shadow.locate(point) {
                        cells.include(&place);
                    }
                }
                if cells != CellRectangle::EMPTY {
                    self.tiles.push(Tile { column, row, cells });
                }
            }
        }
    }

    /// Darkens the pixels of the background on which new shadows fall, and
    /// adds them to `dirty`. Pixels with a face of `faces` are left alone.
    pub(crate) fn cast(
        &self,
        image: &mut Image,
        dirty: &mut [Extent],
        faces: &[u32],
        light: &NewShadows<'_>,
    ) {
        let size = light.rays.size();
        for tile in &self.tiles {
            if !light.reach.touches(&tile.cells) {
                continue;
            }
            for (x, y) in pixels(tile.column, tile.row, size) {
                let pixel = y * size.0 + x;
                if self.light[pixel] == 0 || faces[pixel] != NO_FACE {
                    continue;
                }
                let point = light.rays.point(x, y, self.image.depth_m[pixel]);
                let Some(place) = light.map.locate(point) else {
                    continue;
                };
                if !light.reach.contains(&place) {
                    continue;
                }
                let share = light.map.light_at(&place);
                if share != self.light[pixel] {
                    image.color[pixel] = self.radiance[pixel].color(share);
                    dirty[y].include(x, x + 1);
                }
            }
        }
    }
}

/// The shadows of what was drawn over the background.
pub(crate) struct NewShadows<'a> {
    pub(crate) rays: &'a Rays,
    pub(crate) map: &'a ShadowMap,
    pub(crate) reach: &'a ShadowReach,
}

/// Pixels of a block, row by row.
fn pixels(
    column: usize,
    row: usize,
    (width, height): (usize, usize),
) -> impl Iterator<Item = (usize, usize)> {
    let columns = column..(column + TILE_PX).min(width);
    (row..(row + TILE_PX).min(height)).flat_map(move |y| columns.clone().map(move |x| (x, y)))
}

/// Viewing rays of all columns and rows, scaled to z = 1.
#[derive(Debug)]
pub(crate) struct Rays {
    x: Vec<f32>,
    y: Vec<f32>,
}

impl Rays {
    pub(crate) fn new(camera: &geometry::PinholeCamera) -> Self {
        let ray = |column: u32, row: u32| camera.ray(f64::from(column), f64::from(row));
        Self {
            x: (0..camera.width).map(|u| ray(u, 0).x as f32).collect(),
            y: (0..camera.height).map(|v| ray(0, v).y as f32).collect(),
        }
    }

    pub(crate) fn size(&self) -> (usize, usize) {
        (self.x.len(), self.y.len())
    }

    /// Directions along x of a row's pixels.
    pub(crate) fn x(&self) -> &[f32] {
        &self.x
    }

    /// Directions along y of a column's pixels.
    pub(crate) fn y(&self) -> &[f32] {
        &self.y
    }

    /// The point of a pixel at a depth, camera frame.
    #[inline]
    pub(crate) fn point(&self, column: usize, row: usize, depth_m: f32) -> [f32; 3] {
        [self.x[column] * depth_m, self.y[row] * depth_m, depth_m]
    }
}
