//! Truncated signed distance field: fusion of depth images into a surface.

use crate::depth_view::{DepthPixel, DepthView};
use crate::voxel_block::{BLOCK_SIDE, Block, BlockPlace, Voxel, voxel_index};
use nalgebra::{Isometry3, Point3, Vector3};
use std::collections::HashMap;

/// Distance from the surface up to which voxels are updated, in voxels. Chosen: some standard
/// deviations of the depth of a Kinect within reach of a table.
const TRUNCATION_VOXELS: f32 = 3.0;

/// Weight of a pixel that sees through a voxel, relative to one that sees a surface there.
/// Chosen: free space must outweigh a stray surface, not the edge of a true one.
const FREE_WEIGHT: f32 = 0.3;

/// Maximum number of blocks: 1.3 GB. Chosen: an object of 60 cm has a tenth of it.
const N_BLOCKS_MAX: usize = 1 << 17;

/// Sparse truncated signed distance field with colours (Curless and Levoy 1996), in the frame of
/// the object.
#[derive(Debug)]
pub(crate) struct TsdfVolume {
    voxel_m: f32,
    blocks: Vec<Block>,
    indices: HashMap<BlockPlace, u32>,
    n_views: u32,
    /// Blocks that the present view touches.
    touched: Vec<u32>,
}

impl TsdfVolume {
    /// Empty field with voxels of a side length, metres.
    pub(crate) fn new(voxel_m: f32) -> Self {
        Self {
            voxel_m,
            blocks: Vec::new(),
            indices: HashMap::new(),
            n_views: 0,
            touched: Vec::new(),
        }
    }

    /// Side length of the voxels, metres.
    pub(crate) fn voxel_m(&self) -> f32 {
        self.voxel_m
    }

    /// Number of fused views.
    pub(crate) fn n_views(&self) -> u32 {
        self.n_views
    }

    /// Removes all views; the memory of the blocks stays for the next ones.
    pub(crate) fn clear(&mut self) {
        self.blocks.clear();
        self.indices.clear();
        self.n_views = 0;
    }

    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Block at a place of the grid of blocks.
    pub(crate) fn block(&self, place: &BlockPlace) -> Option<&Block> {
        let index = *self.indices.get(place)?;
        self.blocks.get(index as usize)
    }

    /// Fuses a view, whose camera has a pose in the frame of the object.
    pub(crate) fn fuse(&mut self, view: &DepthView, object_from_camera: &Isometry3<f64>) {
        self.n_views += 1;
        let object_from_camera: Isometry3<f32> = object_from_camera.cast();
        self.allocate(view, &object_from_camera);
        let camera_from_object = object_from_camera.inverse();
        let touched = std::mem::take(&mut self.touched);
        for &index in &touched {
            self.update(index as usize, view, &camera_from_object);
        }
        self.touched = touched;
    }

    /// Marks the blocks along the rays around the surface, and makes those that are missing.
    fn allocate(&mut self, view: &DepthView, object_from_camera: &Isometry3<f32>) {
        self.touched.clear();
        let truncation_m = TRUNCATION_VOXELS * self.voxel_m;
        let block_m = BLOCK_SIDE as f32 * self.voxel_m;
        for pixel in view.pixels() {
            let ray = pixel.place.coords.normalize();
            for step in [-1.0_f32, -0.33, 0.33, 1.0] {
                let place = object_from_camera * (pixel.place + ray * (step * truncation_m));
                let block = place.coords.map(|v| (v / block_m).floor() as i32);
                self.touch(block.into());
            }
        }
    }

    fn touch(&mut self, place: BlockPlace) {
        let n_blocks = self.blocks.len();
        let index = *self.indices.entry(place).or_insert(n_blocks as u32);
        if index as usize == n_blocks {
            if n_blocks >= N_BLOCKS_MAX {
                self.indices.remove(&place);
                return;
            }
            self.blocks.push(Block::new(place));
        }
        let block = &mut self.blocks[index as usize];
        if block.touched != self.n_views {
            block.touched = self.n_views;
            self.touched.push(index);
        }
    }

    /// Updates the voxels of a block by the pixels in which they are seen.
    fn update(&mut self, index: usize, view: &DepthView, camera_from_object: &Isometry3<f32>) {
        let voxel_m = self.voxel_m;
        let truncation_m = TRUNCATION_VOXELS * voxel_m;
        let block = &mut self.blocks[index];
        let first = block
            .place
            .map(|side| voxel_m * ((side * BLOCK_SIDE as i32) as f32 + 0.5));
        let first = camera_from_object * Point3::from(first);
        let steps = [Vector3::x(), Vector3::y(), Vector3::z()]
            .map(|axis: Vector3<f32>| camera_from_object.rotation * axis * voxel_m);
        let camera = &view.camera;
        let (fx, fy) = (camera.fx_px as f32, camera.fy_px as f32);
        let (cx, cy) = (camera.cx_px as f32 + 0.5, camera.cy_px as f32 + 0.5);
        for z in 0..BLOCK_SIDE {
            for y in 0..BLOCK_SIDE {
                let row = first + steps[1] * y as f32 + steps[2] * z as f32;
                for x in 0..BLOCK_SIDE {
                    let place = row + steps[0] * x as f32;
                    if place.z <= 0.0 {
                        continue;
                    }
                    let (column, line) = (fx * place.x / place.z + cx, fy * place.y / place.z + cy);
                    let Some(pixel) = view.pixel(column.floor() as i32, line.floor() as i32) else {
                        continue;
                    };
                    let voxel = &mut block.voxels[voxel_index([x, y, z])];
                    observe(voxel, &place, pixel, truncation_m);
                }
            }
        }
    }
}

/// Updates a voxel by the pixel in which it is seen.
#[inline]
fn observe(voxel: &mut Voxel, place: &Point3<f32>, pixel: &DepthPixel, truncation_m: f32) {
    // Depth of the surface behind the voxel, and distance from the plane of the pixel.
    let behind_m = pixel.place.z - place.z;
    let distance_m = (place - pixel.place).dot(&pixel.normal);
    if behind_m > 0.0 && distance_m > truncation_m {
        voxel.add_distance(truncation_m, FREE_WEIGHT * pixel.weight);
    } else if distance_m.abs() <= truncation_m && behind_m >= -2.0 * truncation_m {
        voxel.add_distance(distance_m, pixel.weight);
        let closeness = 1.0 - distance_m.abs() / truncation_m;
        voxel.add_color(
            &pixel.color,
            pixel.color_weight * closeness + f32::MIN_POSITIVE,
        );
    }
}
