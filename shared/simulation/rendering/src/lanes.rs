//! SIMD lanes: structure-of-arrays storage for one block of pixels.

/// Number of lanes: pixels that are computed together.
pub(crate) const N_LANES: usize = 64;

/// One scalar per pixel of a block.
pub(crate) type Lanes = [f32; N_LANES];
/// One vector or colour per pixel of a block, component by component.
pub(crate) type VectorLanes = [Lanes; 3];
