//! Edge fattening and lateral noise at depth discontinuities.

use super::depth_discontinuity::{for_each_pair, is_jump};
use super::noise_tables::{NoiseKey, NoisePurpose, NoiseTables};
use super::{BorderSpeckle, LateralNoise};
use crate::reflection::Reflection;
use value_range::{OutOfRange, check_range};

/// Number of rows or columns along a border that are displaced together. Chosen.
const COMMON_PX: usize = 4;
/// Greatest outward displacement of a border, pixels. Chosen.
const OUTWARD_MAX_PX: f32 = 3.0;
/// Greatest inward displacement of a border, pixels. Chosen.
const INWARD_MAX_PX: f32 = 2.0;

/// Edge fattening of block matching: a matching window that contains both surfaces mostly matches
/// the nearer one, which moves its border outward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeFattening {
    /// Mean displacement of the edge, pixels; 0 to 3.
    pub mean_px: f32,
    /// Standard deviation of the displacement along the border and between frames, pixels; 0 to
    /// 3.
    pub sigma_px: f32,
}

impl EdgeFattening {
    /// Displacement of one to three pixels, estimated from pictures of real cameras.
    pub const KINECT_V1: Self = Self {
        mean_px: 1.2,
        sigma_px: 0.6,
    };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        check_range("edge_fattening.mean_px", self.mean_px, 0.0, 3.0)?;
        check_range("edge_fattening.sigma_px", self.sigma_px, 0.0, 3.0)
    }
}

/// Border errors of one frame: fattening, lateral noise and speckle.
pub(super) struct BorderNoise<'a> {
    pub(super) fattening: Option<EdgeFattening>,
    /// Lateral noise by the cosine of incidence times 255, pixels; zeros when it is switched off.
    pub(super) lateral_sigmas_px: &'a [f32; 256],
    pub(super) speckle: Option<BorderSpeckle>,
    pub(super) key: NoiseKey,
    pub(super) tables: &'a NoiseTables,
}

/// Lookup table of the lateral noise by the cosine of incidence times 255, pixels.
pub(super) fn lateral_sigmas_px(noise: Option<&LateralNoise>) -> [f32; 256] {
    noise.map_or([0.0; 256], LateralNoise::sigmas_px)
}

/// Border between a pixel and the next one in its row or column.
#[derive(Clone, Copy)]
struct Border {
    /// Index of the nearer pixel.
    near: usize,
    /// Index step from the nearer to the farther pixel.
    outward: isize,
    row: usize,
    column: usize,
    /// True if the other pixel is in the next row.
    is_vertical: bool,
    /// First pixel that the border may move to, and the one after the last.
    bounds: [usize; 2],
}

impl Border {
    /// Pixel at a number of steps outward from the nearer one; `None` outside of the bounds.
    #[inline]
    fn pixel(&self, steps: isize) -> Option<usize> {
        let pixel = self.near.checked_add_signed(steps * self.outward)?;
        (self.bounds[0]..self.bounds[1])
            .contains(&pixel)
            .then_some(pixel)
    }
}

impl BorderNoise<'_> {
    /// Displaces the borders of the `exact` disparities in `seen`, with `width` pixels per row.
    /// Nearer surfaces grow over farther ones; 0 stands for empty pixels.
    pub(super) fn apply(
        &self,
        exact: &[f32],
        reflection: &[Reflection],
        seen: &mut [f32],
        width: usize,
    ) {
        for (row, (here, below)) in exact
            .chunks_exact(width)
            .zip(exact.chunks_exact(width).skip(1).chain([&[][..]]))
            .enumerate()
        {
            let mut meet = |column: usize, is_vertical: bool| {
                let pixel = row * width + column;
                let step = if is_vertical { width } else { 1 };
                let is_first_near = exact[pixel] > exact[pixel + step];
                let border = Border {
                    near: if is_first_near { pixel } else { pixel + step },
                    outward: if is_first_near { 1 } else { -1 } * step as isize,
                    row,
                    column,
                    is_vertical,
                    bounds: if is_vertical {
                        [0, seen.len()]
                    } else {
                        [row * width, (row + 1) * width]
                    },
                };
                self.displace(border, exact, reflection, seen);
            };
            for_each_pair(here, &here[1..], is_jump, |column| meet(column, false));
            for_each_pair(here, below, is_jump, |column| meet(column, true));
        }
    }

    fn displace(&self, border: Border, exact: &[f32], reflection: &[Reflection], seen: &mut [f32]) {
        let hash = self.key.hash(
            NoisePurpose::Border,
            border.row * 2 + usize::from(border.is_vertical),
            border.column,
        );
        let cosine = reflection[border.near].cos_incidence;
        let shift = self.shift_px(border, cosine, hash);
        if shift > 0.0 {
            let front = seen[border.near].max(exact[border.near]);
            for pixel in (1..=shift as isize).map_while(|steps| border.pixel(steps)) {
                seen[pixel] = seen[pixel].max(front);
            }
        } else if shift < 0.0 {
            let beyond = (border.near as isize + border.outward) as usize;
            let behind = seen[beyond].min(exact[beyond]);
            for pixel in (0..(-shift) as isize).map_while(|steps| border.pixel(-steps)) {
                seen[pixel] = behind;
            }
        }
        if let Some(speckle) = self.speckle {
            self.speckle(border, shift, speckle.missing_share, seen);
        }
    }

    /// Outward displacement of a border, rounded to whole pixels.
    #[inline]
    fn shift_px(&self, border: Border, cosine: u8, hash: u64) -> f32 {
        let along = if border.is_vertical {
            (border.row, border.column / COMMON_PX)
        } else {
            (border.row / COMMON_PX, border.column / COMMON_PX)
        };
        let common = self.tables.one_normal(self.key.hash(
            NoisePurpose::BorderCommon,
            along.0 * 2 + usize::from(border.is_vertical),
            along.1,
        ));
        let (mean, sigma) = self
            .fattening
            .map_or((0.0, 0.0), |term| (term.mean_px, term.sigma_px));
        let own = self.tables.one_normal(hash) * self.lateral_sigmas_px[usize::from(cosine)];
        let shift = mean + sigma * common + own;
        crate::rounding::round(shift.clamp(-INWARD_MAX_PX, OUTWARD_MAX_PX))
    }

    /// Border speckle: randomly clears one of the pixels around a displaced border.
    fn speckle(&self, border: Border, shift: f32, missing_share: f32, seen: &mut [f32]) {
        let hash = self.key.hash(
            NoisePurpose::Speckle,
            border.row * 2 + usize::from(border.is_vertical),
            border.column,
        );
        let chance = (hash >> 40) as f32 / 16_777_216.0;
        if chance < missing_share {
            let offset = shift as isize + (hash & 3) as isize - 1;
            if let Some(pixel) = border.pixel(offset) {
                seen[pixel] = 0.0;
            }
        }
    }
}
