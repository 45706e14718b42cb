//! Surface points: zero crossings of the signed distances along the edges of the voxel grid.

use crate::tsdf_volume::TsdfVolume;
use crate::voxel_block::{BLOCK_LEN, BLOCK_SIDE, Block, Voxel, voxel_index};
use nalgebra::{Point3, Vector3};

/// Point of the surface of a model, in the frame of the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Place, metres.
    pub place: Point3<f32>,
    /// Outward unit normal.
    pub normal: Vector3<f32>,
    /// sRGB colour.
    pub color: [u8; 3],
    /// Certainty of the colour: 1 for one facing pixel at 0.8 m.
    pub color_weight: f32,
}

/// Zero crossing between two voxels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    /// Share of the way from the first voxel to the second one, 0 to 1.
    pub(crate) share: f32,
    pub(crate) color: [u8; 3],
    pub(crate) color_weight: f32,
}

/// Zero crossing between two neighbouring voxels; `None` if they are on one side, or not seen
/// with the weight.
pub(crate) fn crossing(from: &Voxel, to: &Voxel, weight_min: f32) -> Option<Crossing> {
    let is_seen = from.weight >= weight_min && to.weight >= weight_min;
    if !is_seen || (from.distance_m < 0.0) == (to.distance_m < 0.0) {
        return None;
    }
    let share = from.distance_m / (from.distance_m - to.distance_m);
    Some(Crossing {
        share,
        color: mixed_color(from, to, share),
        color_weight: from.color_weight.max(to.color_weight),
    })
}

/// Colour between two voxels, by their distances and certainties.
fn mixed_color(from: &Voxel, to: &Voxel, share: f32) -> [u8; 3] {
    let (near, far) = ((1.0 - share) * from.color_weight, share * to.color_weight);
    let total = (near + far).max(f32::MIN_POSITIVE);
    [0, 1, 2].map(|i| ((near * from.color[i] + far * to.color[i]) / total).round() as u8)
}

/// Coordinates of the voxels of a block, in the order of their storage.
pub(crate) fn voxel_places() -> impl Iterator<Item = [usize; 3]> {
    (0..BLOCK_LEN).map(|i| {
        [
            i % BLOCK_SIDE,
            i / BLOCK_SIDE % BLOCK_SIDE,
            i / (BLOCK_SIDE * BLOCK_SIDE),
        ]
    })
}

/// Blocks that follow a block along x, y and z in all combinations; bit 0 stands for x.
pub(crate) fn following<'a>(volume: &'a TsdfVolume, block: &'a Block) -> [Option<&'a Block>; 8] {
    std::array::from_fn(|bits| {
        if bits == 0 {
            return Some(block);
        }
        let place = std::array::from_fn(|axis| block.place[axis] + (bits >> axis & 1) as i32);
        volume.block(&place)
    })
}

/// Voxel at coordinates of up to one block side beyond a block.
#[inline]
pub(crate) fn voxel_at<'a>(
    blocks: &[Option<&'a Block>; 8],
    place: [usize; 3],
) -> Option<&'a Voxel> {
    let bits =
        (place[0] / BLOCK_SIDE) | (place[1] / BLOCK_SIDE) << 1 | (place[2] / BLOCK_SIDE) << 2;
    let block = blocks[bits]?;
    Some(&block.voxels[voxel_index(place.map(|v| v % BLOCK_SIDE))])
}

impl TsdfVolume {
    /// Centre of the first voxel of a block plus whole voxels, metres.
    pub(crate) fn voxel_centre(&self, block: &Block, place: [usize; 3]) -> Point3<f32> {
        let side = |axis: usize| {
            let index = block.place[axis] * BLOCK_SIDE as i32 + place[axis] as i32;
            self.voxel_m() * (index as f32 + 0.5)
        };
        Point3::new(side(0), side(1), side(2))
    }

    /// Surface points of the field, seen with a weight at least.
    pub(crate) fn surface_points(&self, weight_min: f32) -> Vec<SurfacePoint> {
        let mut points = Vec::new();
        for block in self.blocks() {
            let blocks = following(self, block);
            for place in voxel_places() {
                let own = &block.voxels[voxel_index(place)];
                if own.weight < weight_min {
                    continue;
                }
                for axis in 0..3 {
                    let mut next = place;
                    next[axis] += 1;
                    let Some(other) = voxel_at(&blocks, next) else {
                        continue;
                    };
                    let Some(found) = crossing(own, other, weight_min) else {
                        continue;
                    };
                    let Some(normal) = gradient(&blocks, place).try_normalize(1e-6) else {
                        continue;
                    };
                    let mut at = self.voxel_centre(block, place);
                    at[axis] += found.share * self.voxel_m();
                    points.push(SurfacePoint {
                        place: at,
                        normal,
                        color: found.color,
                        color_weight: found.color_weight,
                    });
                }
            }
        }
        points
    }
}

/// Forward differences of the distances at a voxel.
fn gradient(blocks: &[Option<&Block>; 8], place: [usize; 3]) -> Vector3<f32> {
    let distance = |place| {
        voxel_at(blocks, place)
            .filter(|v| v.weight > 0.0)
            .map(|v| v.distance_m)
    };
    let own = distance(place).unwrap_or(0.0);
    Vector3::from([0, 1, 2].map(|axis| {
        let mut next = place;
        next[axis] += 1;
        distance(next).map_or(0.0, |other| other - own)
    }))
}
