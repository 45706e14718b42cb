//! A shaded pixel, ready to be written to the image.

use crate::radiance::Radiance;
use crate::reflection::Reflection;

/// Shaded pixel with its position, depth, colour and reflection.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LitPixel {
    pub(crate) row: usize,
    pub(crate) column: usize,
    pub(crate) instance: u16,
    pub(crate) depth_m: f32,
    pub(crate) radiance: Radiance,
    /// Share of the main light that arrives, times 255; 0 where the main light has no effect.
    pub(crate) light: u8,
    /// Shadow map coordinates of the pixel, cells.
    pub(crate) place: [f32; 2],
    pub(crate) color: [u16; 3],
    pub(crate) reflection: Reflection,
}
