//! How a Kinect v1 measures a scene: structured light seen by an infrared
//! camera, disparity in eighths of a pixel on an 11-bit scale.

use point_cloud::{Point, Rgba};

/// Distance from the infrared camera to the projector, along the camera's x
/// axis, metres.
pub(super) const BASELINE_M: f64 = 0.075;
/// Columns at the right border for which the correlation window ends outside
/// the image.
pub(super) const N_BLIND_COLUMNS: usize = 8;

/// Reading of an infinitely far point.
const RAW_AT_INFINITY: f32 = 1090.0;
/// Steps of the reading per pixel of disparity.
const STEPS_PER_PX: f64 = 8.0;
/// Cosines of incidence below which all light, and above which none, is lost.
const GRAZING: [f64; 2] = [0.12, 0.3];
/// Probability that a pixel is lost anywhere, and behind an edge, in 1/256.
const LOSS_ANYWHERE: f64 = 1.0;
const LOSS_BEHIND_EDGE: f64 = 110.0;

/// All that does not change from frame to frame about one pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelModel {
    /// Reading without noise, steps; real-valued.
    pub(super) raw: f32,
    /// Standard deviation of the reading, steps.
    deviation: f32,
    /// Without noise; each channel at least 4 from the ends of its range.
    color: Rgba,
    /// Probability of a missing depth, in 1/256.
    pub(super) loss: u32,
}

/// What a pixel's loss depends on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surroundings {
    /// Cosine of the angle between ray and normal.
    pub(super) incidence: f64,
    /// Whether a neighbour is clearly nearer. The correlation window then mixes
    /// both, and the nearer surface, which is brighter, prevails.
    pub(super) is_behind_edge: bool,
    /// Whether the projector's light does not get there.
    pub(super) is_in_shadow: bool,
}

/// Converts depth and disparity readings for one focal length.
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

    /// The model of a pixel that sees a surface at depth `z_m`.
    pub(super) fn model(self, z_m: f64, rgb: [u8; 3], around: Surroundings) -> PixelModel {
        let z = z_m as f32;
        let steps = self.steps_m / z;
        PixelModel {
            raw: RAW_AT_INFINITY - steps,
            deviation: depth_deviation_m(z_m) as f32 * steps / z,
            color: rgba(rgb),
            loss: loss(around),
        }
    }

    /// One reading of a pixel, from 64 random bits.
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
    /// A pixel that looks at nothing.
    pub(super) fn nothing() -> Self {
        Self {
            raw: 0.0,
            deviation: 0.0,
            color: rgba([0; 3]),
            loss: 256,
        }
    }
}

/// Standard deviation of the depth along the axis (Nguyen, Izadi and Lovell
/// 2012, equation 4), metres.
pub(super) fn depth_deviation_m(z_m: f64) -> f64 {
    0.0012 + 0.0019 * (z_m - 0.4).powi(2)
}

fn loss(around: Surroundings) -> u32 {
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

/// Brightens or darkens all channels by up to 4; they leave room for that, so
/// one addition does all three.
#[inline]
fn noisy(color: Rgba, bits: u64) -> Rgba {
    let step = (bits & 7) as i32 - 4;
    Rgba(color.0.wrapping_add((0x0001_0101 * step) as u32))
}

/// A number of mean 0 and deviation 1 from the lower 48 of 64 random bits: the
/// sum of four uniform ones. Never beyond 3.465, so that no point is ever far off.
#[inline]
fn gaussian(bits: u64) -> f32 {
    // Four times 12 bits; the deviation of their sum is 4096 / sqrt(3).
    let sum = (bits & 0xfff) + (bits >> 12 & 0xfff) + (bits >> 24 & 0xfff) + (bits >> 36 & 0xfff);
    (sum as i32 - 8190) as f32 * (1.732_050_8 / 4096.0)
}
