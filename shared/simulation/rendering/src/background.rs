//! Cached image of the static background, with incremental shadow updates.

use crate::dirty_shadow_blocks::{CellRectangle, DirtyShadowBlocks};
use crate::image::Image;
use crate::lanes::{N_LANES, VectorLanes};
use crate::lit_pixel::LitPixel;
use crate::pixel_rays::PixelRays;
use crate::radiance::Radiance;
use crate::shadow_map::{ShadowCoordinates, ShadowMap};
use crate::visibility_buffer::{ColumnRange, NO_FACE, VisibilityBuffer};
use std::ops::Range;

/// Side of the square tiles in which pixels are tested for new shadows, pixels.
const TILE_PX: usize = 8;
const _: () = assert!(TILE_PX * TILE_PX == N_LANES);

/// Cached background: its image, depth and light, for drawing moving instances over it.
#[derive(Debug)]
pub(crate) struct Background {
    /// True if the background has no instances.
    pub(crate) is_empty: bool,
    pub(crate) image: Image,
    pub(crate) reverse_z: Vec<f32>,
    pub(crate) shadow: Vec<f32>,
    pub(crate) radiance: Vec<Radiance>,
    /// Share of the main light in each pixel, times 255; 0 where the main light has no effect.
    pub(crate) light: Vec<u8>,
    /// Shadow map cells of the lit pixels of each tile, as bounding rectangles.
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
            reverse_z: vec![0.0; n_pixels],
            shadow: Vec::new(),
            radiance: vec![Radiance::default(); n_pixels],
            light: vec![0; n_pixels],
            tiles: vec![CellRectangle::EMPTY; n_tiles],
        }
    }

    /// Caches a finished image with its depth buffer and shadow map.
    pub(crate) fn keep(
        &mut self,
        image: &Image,
        visibility: &VisibilityBuffer,
        shadow: &ShadowMap,
    ) {
        self.image.copy_span(image, 0..image.depth_m.len());
        self.reverse_z.clone_from(&visibility.reverse_z);
        self.shadow.clone_from(&shadow.reverse_z);
    }

    /// Clears the cached light of all pixels.
    pub(crate) fn clear_light(&mut self) {
        self.light.fill(0);
        self.tiles.fill(CellRectangle::EMPTY);
    }

    /// Caches the light of a pixel and its shadow map coordinates.
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

    /// Incremental shadow update: darkens the background pixels on which new shadows fall, and
    /// adds them to `dirty`. Pixels that show a face of `faces` are skipped.
    pub(crate) fn cast(
        &self,
        image: &mut Image,
        dirty: &mut [ColumnRange],
        faces: &[u32],
        light: &ShadowUpdate<'_>,
    ) {
        let (width, height) = light.rays.size();
        let mut tile = Tile::new();
        for (i, cells) in self.tiles.iter().enumerate() {
            if !light.dirty_blocks.touches(cells) {
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
                    || !light.dirty_blocks.contains(&place)
                {
                    return;
                }
                let share = light.map.lit_share(&place);
                if share != self.light[pixel] {
                    image.color[pixel] = self.radiance[pixel].color(share);
                    dirty[y].include(x, x + 1);
                }
            });
        }
    }
}

/// Number of tiles along `n_pixels` pixels.
fn n_tiles(n_pixels: usize) -> usize {
    n_pixels.div_ceil(TILE_PX)
}

/// Tile of pixels with their shadow map coordinates.
struct Tile {
    rows: Range<usize>,
    columns: Range<usize>,
    points: VectorLanes,
    places: ShadowCoordinates,
}

impl Tile {
    fn new() -> Self {
        Self {
            rows: 0..0,
            columns: 0..0,
            points: [[0.0; N_LANES]; 3],
            places: ShadowCoordinates::new(),
        }
    }

    fn locate(&mut self, depth_m: &[f32], light: &ShadowUpdate<'_>) {
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
        light.map.project_all(&self.points, &mut self.places);
    }

    /// Calls `visit` with lane, column and row of each pixel.
    fn for_each_pixel(&self, mut visit: impl FnMut(usize, usize, usize)) {
        for (j, row) in self.rows.clone().enumerate() {
            for (i, column) in self.columns.clone().enumerate() {
                visit(j * TILE_PX + i, column, row);
            }
        }
    }
}

/// Inputs of the incremental shadow update.
pub(crate) struct ShadowUpdate<'a> {
    pub(crate) rays: &'a PixelRays,
    pub(crate) map: &'a ShadowMap,
    pub(crate) dirty_blocks: &'a DirtyShadowBlocks,
}
