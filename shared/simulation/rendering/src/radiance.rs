//! Outgoing light of a pixel, split into the parts with and without the main light.

use crate::rounding::floor;

/// Channel value of [`crate::Image::color`] for fully lit white. Values up to 65 535 are kept, so
/// that exposure can be chosen afterwards.
pub const LINEAR_ONE: f32 = 8192.0;

/// Radiance of a pixel, linear sRGB: without the main light, and the part that the unshadowed
/// main light adds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Radiance {
    pub(crate) unlit: [f32; 3],
    pub(crate) lit: [f32; 3],
}

impl Radiance {
    /// True if a shadow of the main light is visible on it.
    #[inline]
    pub(crate) fn has_main_light(&self) -> bool {
        self.lit != [0.0; 3]
    }

    /// Image colour for a share of `light` / 255 of the main light.
    #[inline]
    pub(crate) fn color(&self, light: u8) -> [u16; 3] {
        std::array::from_fn(|i| color_channel(self.unlit[i], self.lit[i], light))
    }
}

/// Single channel of [`Radiance::color`].
#[inline]
pub(crate) fn color_channel(unlit: f32, lit: f32, light: u8) -> u16 {
    let share = f32::from(light) * (1.0 / 255.0);
    let value = (unlit + lit * share) * LINEAR_ONE + 0.5;
    floor(value.clamp(0.0, 65_535.0)) as u16
}
