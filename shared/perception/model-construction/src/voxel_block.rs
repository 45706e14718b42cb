//! Blocks of voxels: the sparse storage of a truncated signed distance field.

/// Number of voxels along the side of a block.
pub(crate) const BLOCK_SIDE: usize = 8;

/// Number of voxels of a block.
pub(crate) const BLOCK_LEN: usize = BLOCK_SIDE * BLOCK_SIDE * BLOCK_SIDE;

/// Coordinates of a block in the grid of blocks.
pub(crate) type BlockPlace = [i32; 3];

/// Weighted means in one voxel.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Voxel {
    /// Signed distance from the surface, metres: positive outside.
    pub(crate) distance_m: f32,
    /// Sum of the weights of the distances.
    pub(crate) weight: f32,
    /// Colour near the surface, 0 to 255 a channel.
    pub(crate) color: [f32; 3],
    /// Sum of the weights of the colours.
    pub(crate) color_weight: f32,
}

/// Cube of voxels.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    pub(crate) place: BlockPlace,
    /// Voxels, x fastest.
    pub(crate) voxels: Box<[Voxel; BLOCK_LEN]>,
    /// Number of the view that last touched the block.
    pub(crate) touched: u32,
}

impl Block {
    pub(crate) fn new(place: BlockPlace) -> Self {
        Self {
            place,
            voxels: Box::new([Voxel::default(); BLOCK_LEN]),
            touched: 0,
        }
    }
}

impl Voxel {
    /// Adds a measured distance.
    pub(crate) fn add_distance(&mut self, distance_m: f32, weight: f32) {
        let sum = self.weight + weight;
        self.distance_m += (distance_m - self.distance_m) * weight / sum;
        self.weight = sum;
    }

    /// Adds a measured colour.
    pub(crate) fn add_color(&mut self, color: &[f32; 3], weight: f32) {
        self.color_weight += weight;
        let share = weight / self.color_weight;
        for (mean, value) in self.color.iter_mut().zip(color) {
            *mean += (value - *mean) * share;
        }
    }
}

/// Index of a voxel in its block, from its coordinates in the block.
pub(crate) fn voxel_index([x, y, z]: [usize; 3]) -> usize {
    (z * BLOCK_SIDE + y) * BLOCK_SIDE + x
}
