//! What does not move, drawn once.

use crate::image::Image;
use crate::pixel_block::{LANES, LitPixel, Vectors};
use crate::shading::Radiance;
use crate::shadow_map::{Places, ShadowMap};
use crate::shadow_reach::{CellRectangle, ShadowReach};
use crate::visibility::{Extent, NO_FACE, Visibility};
use std::ops::Range;

/// Side of the blocks of pixels that are checked for new shadows together.
const TILE_PX: usize = 8;
const _: () = assert!(TILE_PX * TILE_PX == LANES);

/// The image of what does not move, and what is needed to draw over it.
#[derive(Debug)]
pub(crate) struct Background {
    /// Whether there is nothing.
    pub(crate) is_empty: bool,
    pub(crate) image: Image,
    pub(crate) closeness: Vec<f32>,
    pub(crate) shadow: Vec<f32>,
    pub(crate) radiance: Vec<Radiance>,
    /// Share of the main light in each pixel, times 255; 0 where none arrives anyway.
    pub(crate) light: Vec<u8>,
    /// Where the lit pixels of each block lie in the shadow map, block by block.
    tiles: Vec<CellRectangle>,
}

impl Background {
    pub(crate) fn new(image: Image) -> Self {
        let n_pixels = image.depth_m.len();
        let (width, height) = (image.camera().width, image.camera().height);
        let n_tiles = n_tiles(width as usize) * n_tiles(height as usize);
        Self {
            is_empty: false,
            image,
            closeness: vec![0.0; n_pixels],
            shadow: Vec::new(),
            radiance: vec![Radiance::default(); n_pixels],
            light: vec![0; n_pixels],
            tiles: vec![CellRectangle::EMPTY; n_tiles],
        }
    }

    /// Keeps a finished image and finds where shadows may fall later.
    pub(crate) fn keep(&mut self, image: &Image, visibility: &Visibility, shadow: &ShadowMap) {
        self.image.copy_span(image, 0..image.depth_m.len());
        self.closeness.clone_from(&visibility.closeness);
        self.shadow.clone_from(&shadow.closeness);
    }

    /// Forgets all light.
    pub(crate) fn clear_light(&mut self) {
        self.light.fill(0);
        self.tiles.fill(CellRectangle::EMPTY);
    }

    /// Keeps the light of a pixel and where a shadow would fall on it.
    #[inline]
    pub(crate) fn keep_light(&mut self, pixel: usize, lit: &LitPixel) {
        self.radiance[pixel] = lit.radiance;
        self.light[pixel] = lit.light;
        if lit.light > 0 {
            let width = self.image.camera().width as usize;
            let tile = lit.row / TILE_PX * n_tiles(width) + lit.column / TILE_PX;
            self.tiles[tile].include(lit.place);
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
        let (width, height) = light.rays.size();
        let mut tile = Tile::new();
        for (i, cells) in self.tiles.iter().enumerate() {
            if !light.reach.touches(cells) {
                continue;
            }
            let (row, column) = (i / n_tiles(width), i % n_tiles(width));
            tile.rows = row * TILE_PX..((row + 1) * TILE_PX).min(height);
            tile.columns = column * TILE_PX..((column + 1) * TILE_PX).min(width);
            tile.locate(&self.image.depth_m, light);
            tile.for_each_pixel(|lane, x, y| {
                let pixel = y * width + x;
                let place = tile.places.at(lane);
                if self.light[pixel] == 0
                    || faces[pixel] != NO_FACE
                    || !light.reach.contains(&place)
                {
                    return;
                }
                let share = light.map.light_at(&place);
                if share != self.light[pixel] {
                    image.color[pixel] = self.radiance[pixel].color(share);
                    dirty[y].include(x, x + 1);
                }
            });
        }
    }
}

/// How many blocks lie along so many pixels.
fn n_tiles(n_pixels: usize) -> usize {
    n_pixels.div_ceil(TILE_PX)
}

/// A block of pixels, and where they lie in the shadow map.
struct Tile {
    rows: Range<usize>,
    columns: Range<usize>,
    points: Vectors,
    places: Places,
}

impl Tile {
    fn new() -> Self {
        Self {
            rows: 0..0,
            columns: 0..0,
            points: [[0.0; LANES]; 3],
            places: Places::new(),
        }
    }

    fn locate(&mut self, depth_m: &[f32], light: &NewShadows<'_>) {
        let width = light.rays.size().0;
        let [px, py, pz] = &mut self.points;
        for (j, row) in self.rows.clone().enumerate() {
            let lanes = j * TILE_PX..j * TILE_PX + self.columns.len();
            let depth_m = &depth_m[row * width..][self.columns.clone()];
            let (x, y) = (&light.rays.x()[self.columns.clone()], light.rays.y()[row]);
            pz[lanes.clone()].copy_from_slice(depth_m);
            for (py, &depth_m) in py[lanes.clone()].iter_mut().zip(depth_m) {
                *py = y * depth_m;
            }
            for (px, (&x, &depth_m)) in px[lanes].iter_mut().zip(x.iter().zip(depth_m)) {
                *px = x * depth_m;
            }
        }
        light.map.locate_all(&self.points, &mut self.places);
    }

    /// Calls `visit` with lane, column and row.
    fn for_each_pixel(&self, mut visit: impl FnMut(usize, usize, usize)) {
        for (j, row) in self.rows.clone().enumerate() {
            for (i, column) in self.columns.clone().enumerate() {
                visit(j * TILE_PX + i, column, row);
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
}
