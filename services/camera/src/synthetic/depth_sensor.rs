//! Depth sensor model of a Kinect v1: structured light, disparity quantised to eighths of
//! a pixel on an 11-bit scale.

use point_cloud::{Point, Rgba};

/// Baseline between the infrared camera and the projector along the camera's x axis,
/// metres.
pub(super) const BASELINE_M: f64 = 0.075;
/// Number of columns at the right border without depth: the correlation window ends
/// outside the image.
pub(super) const N_BLIND_COLUMNS: usize = 8;

/// Disparity reading of an infinitely far point.
const RAW_AT_INFINITY: f32 = 1090.0;
/// Quantisation steps per pixel of disparity.
const STEPS_PER_PX: f64 = 8.0;
/// Cosines of incidence between which the loss falls from all to none. Chosen.
const GRAZING: [f64; 2] = [0.12, 0.3];
/// Loss probability of any pixel, in 1/256. Chosen, as is that behind an edge.
const LOSS_ANYWHERE: f64 = 1.0;
const LOSS_BEHIND_EDGE: f64 = 110.0;

/// Static sensor model of one pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelModel {
    /// Disparity reading of the pixel without noise, steps; real-valued.
    pub(super) raw: f32,
    /// Standard deviation of the disparity reading, steps.
    deviation: f32,
    /// Colour without noise; each channel at least 4 from the ends of its range.
    color: Rgba,
    /// Probability of missing depth, in 1/256.
    pub(super) loss: u32,
}

/// Geometric causes of missing depth at a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelVisibility {
    /// Cosine of the angle of incidence at the surface.
    pub(super) incidence: f64,
    /// True if a neighbour is clearly nearer. The correlation window then mixes both, and
    /// the nearer surface, which is brighter, prevails.
    pub(super) is_behind_edge: bool,
    /// True if the projector's light does not reach the surface.
    pub(super) is_in_shadow: bool,
}

/// Conversion between depth and disparity for one focal length.
#[derive(Debug, Clone, Copy)]
pub(super) struct DepthSensor {
    /// Product of disparity in steps and depth, metres.
    steps_m: f32,
}

impl DepthSensor {
    pub(super) fn new(fx_px: f64) -> Self {
        Self {
            steps_m: (STEPS_PER_PX * BASELINE_M * fx_px) as f32,
        }
    }

    /// Model of a pixel that sees a surface at depth `z_m`, metres.
    pub(super) fn model(self, z_m: f64, rgb: [u8; 3], around: PixelVisibility) -> PixelModel {
        let z = z_m as f32;
        let steps = self.steps_m / z;
        PixelModel {
            raw: RAW_AT_INFINITY - steps,
            deviation: depth_deviation_m(z_m) as f32 * steps / z,
            color: rgba(rgb),
            loss: loss(around),
        }
    }

    /// One noisy reading of a pixel, from 64 random bits.
    ///
    /// `slope` is the pixel's viewing ray, x and y at z = 1.
    #[inline]
    pub(super) fn read(self, pixel: &PixelModel, slope: [f32; 2], bits: u64) -> Point {
        let color = noisy(pixel.color, bits >> 56);
        if ((bits >> 48 & 0xff) as u32) < pixel.loss {
            return Point::without_depth(color);
        }
        let raw = (pixel.raw + pixel.deviation * gaussian(bits) + 0.5) as i32;
        let z = self.steps_m / (RAW_AT_INFINITY - raw as f32);
        Point {
            x: slope[0] * z,
            y: slope[1] * z,
            z,
            color,
        }
    }
}

impl PixelModel {
    /// Model of a pixel that sees no surface.
    pub(super) fn nothing() -> Self {
        Self {
            raw: 0.0,
            deviation: 0.0,
            color: rgba([0; 3]),
            loss: 256,
        }
    }
}

/// Axial depth noise, standard deviation in metres (Nguyen, Izadi and Lovell 2012,
/// equation 4).
pub(super) fn depth_deviation_m(z_m: f64) -> f64 {
    0.0012 + 0.0019 * (z_m - 0.4).powi(2)
}

fn loss(around: PixelVisibility) -> u32 {
    if around.is_in_shadow {
        return 256;
    }
    let [none, all] = GRAZING;
    let grazing = ((all - around.incidence) / (all - none)).clamp(0.0, 1.0) * 256.0;
    let edge = if around.is_behind_edge {
        LOSS_BEHIND_EDGE
    } else {
        0.0
    };
    (LOSS_ANYWHERE + edge + grazing) as u32
}

fn rgba(rgb: [u8; 3]) -> Rgba {
    let [r, g, b] = rgb.map(|channel| channel.clamp(4, 251));
    Rgba::opaque(r, g, b)
}

/// Colour noise: brightens or darkens all channels by up to 4 with one addition, for
/// which they leave room.
#[inline]
fn noisy(color: Rgba, bits: u64) -> Rgba {
    let step = (bits & 7) as i32 - 4;
    Rgba(color.0.wrapping_add((0x0001_0101 * step) as u32))
}

/// Approximate normal variate (mean 0, deviation 1): the sum of four uniform variates
/// from the lower 48 of 64 random bits. Never beyond 3.465, so that no point is far off.
#[inline]
fn gaussian(bits: u64) -> f32 {
    // Four times 12 bits; the deviation of their sum is 4096 / sqrt(3).
    let sum = (bits & 0xfff) + (bits >> 12 & 0xfff) + (bits >> 24 & 0xfff) + (bits >> 36 & 0xfff);
    (sum as i32 - 8190) as f32 * (1.732_050_8 / 4096.0)
}
