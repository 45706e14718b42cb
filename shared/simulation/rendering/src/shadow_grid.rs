//! Cell and block grid of the shadow map.

/// Number of cells on each side of the shadow map. Chosen: a cell is about 6 mm wide in a region
/// of 1.2 m radius.
pub(crate) const MAP_SIDE: usize = 384;
/// Number of cells on each side of a block.
pub(crate) const BLOCK: usize = 4;
/// Number of blocks on each side of the map.
pub(crate) const N_BLOCKS: usize = MAP_SIDE / BLOCK;
