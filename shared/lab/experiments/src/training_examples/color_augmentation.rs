//! Colour augmentation: other white balance, exposure, saturation, noise and registration of the
//! colour image than the simulated camera has.

use point_cloud::{Point, Rgba};
use random::Random;

/// Standard deviation of the logarithm of the gain of a channel: the white balance.
const CHANNEL_GAIN_SIGMA: f64 = 0.10;

/// Standard deviation of the logarithm of the gain of all channels: the exposure.
const GAIN_SIGMA: f64 = 0.15;

/// Range of the factor of saturation.
const SATURATION: [f64; 2] = [0.6, 1.4];

/// Value of a channel around which the contrast changes.
const MIDDLE: f64 = 128.0;

/// Greatest standard deviation of the noise of a channel, 0 to 255.
const NOISE_MAX: f64 = 5.0;

/// Greatest offset of the colour image from the depth image, pixels along rows and columns.
const OFFSET_MAX_PX: f64 = 2.4;

/// Share of the images with little contrast, where only the shape parts objects of one colour.
const PALE_SHARE: f64 = 0.25;

/// Greatest factor of the contrast of such an image.
const PALE_CONTRAST_MAX: f64 = 0.3;

/// Colours as another camera sees them.
struct ColorResponse {
    gains: [f64; 3],
    saturation: f64,
    contrast: f64,
    /// Standard deviation of the noise of a channel.
    noise: f64,
}

impl ColorResponse {
    fn random(random: &mut Random) -> Self {
        let exposure = GAIN_SIGMA * random.normal();
        let gains = [0; 3].map(|_| (exposure + CHANNEL_GAIN_SIGMA * random.normal()).exp());
        let is_pale = random.unit() < PALE_SHARE;
        Self {
            gains,
            saturation: random.between(SATURATION[0], SATURATION[1]),
            contrast: if is_pale {
                random.between(0.0, PALE_CONTRAST_MAX)
            } else {
                1.0
            },
            noise: random.between(0.0, NOISE_MAX),
        }
    }

    fn apply(&self, rgb: [u8; 3], random: &mut Random) -> Rgba {
        let rgb = rgb.map(f64::from);
        let grey = rgb.iter().sum::<f64>() / 3.0;
        let [r, g, b] = [0, 1, 2].map(|channel| {
            let value = grey + self.saturation * (rgb[channel] - grey);
            let value = MIDDLE + self.contrast * (value - MIDDLE);
            // Uniform noise of the given deviation.
            let noise = self.noise * 12_f64.sqrt() * (random.unit() - 0.5);
            (value * self.gains[channel] + noise).clamp(0.0, 255.0) as u8
        });
        Rgba::opaque(r, g, b)
    }
}

/// Change the colours of an image of `width` columns as another camera would see them.
pub(super) fn augment(points: &mut [Point], width: usize, random: &mut Random) {
    let response = ColorResponse::random(random);
    let offset = [0; 2].map(|_: i32| {
        let offset_px = random.between(-OFFSET_MAX_PX, OFFSET_MAX_PX);
        offset_px.round() as isize
    });
    let size = [width, points.len() / width];
    let colors: Vec<[u8; 3]> = points.iter().map(|point| point.color.rgb()).collect();
    for (i, point) in points.iter_mut().enumerate() {
        let [column, row] = [0, 1].map(|axis| {
            let at = if axis == 0 { i % width } else { i / width };
            at.saturating_add_signed(offset[axis]).min(size[axis] - 1)
        });
        point.color = response.apply(colors[row * width + column], random);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn augmentation_keeps_the_depth_and_depends_on_the_seed_alone() {
        let point = |i: usize| Point {
            x: i as f32,
            y: 0.0,
            z: 1.0,
            color: Rgba::opaque((i % 256) as u8, 80, 200),
        };
        let points: Vec<Point> = (0..600).map(point).collect();
        let augmented = |seed: u64| {
            let mut points = points.clone();
            augment(&mut points, 30, &mut Random::from_seed(seed));
            points
        };
        let [one, again, other] = [1, 1, 2].map(augmented);
        assert_eq!(one, again);
        assert_ne!(one, other);
        let positions = |points: &[Point]| points.iter().map(Point::position).collect::<Vec<_>>();
        assert_eq!(positions(&one), positions(&points));
    }
}
