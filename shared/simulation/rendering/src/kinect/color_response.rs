//! Colour camera response: exposure, white balance, vignetting, noise, demosaicing blur and sRGB
//! encoding.

use super::noise_tables::{NoiseKey, NoisePurpose, NoiseTables};
use crate::illuminant::black_body_rgb;
use crate::radiance::LINEAR_ONE;
use value_range::{OutOfRange, check_range};

/// Number of entries of the sRGB encoding table.
const CODES: usize = 4096;
/// Number of channel values in a block of 64 pixels, which shares one position in the noise
/// tables.
const BLOCK: usize = 192;

/// Colour response from light to bytes: lens, exposure, white balance, sensor noise, demosaicing
/// blur and the sRGB curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColorResponse {
    /// Exposure: factor on all light; 0.01 to 100.
    pub exposure: f32,
    /// White balance: colour temperature that is rendered grey, kelvin; 1000 to 15 000.
    pub white_k: f32,
    /// Vignetting: share of light lost in the image corners; 0 to 0.9.
    pub vignetting: f32,
    /// Variance of the shot noise, relative to the value of a white pixel; 0 to 0.1.
    pub shot_variance: f32,
    /// Standard deviation of the read noise, relative to white; 0 to 0.1.
    pub read_sigma: f32,
    /// True if neighbouring pixels are blended 1:2:1 in rows and columns, as demosaicing does.
    pub is_blurred: bool,
}

impl ColorResponse {
    /// Small indoor video camera; estimated from pictures of real cameras.
    pub const KINECT_V1: Self = Self {
        exposure: 1.0,
        white_k: 4600.0,
        vignetting: 0.18,
        shot_variance: 3.5e-4,
        read_sigma: 5e-3,
        is_blurred: true,
    };

    /// Ideal camera: exact colours under daylight.
    pub const PERFECT: Self = Self {
        exposure: 1.0,
        white_k: 6500.0,
        vignetting: 0.0,
        shot_variance: 0.0,
        read_sigma: 0.0,
        is_blurred: false,
    };

    pub(super) fn check(&self) -> Result<(), OutOfRange<f32>> {
        check_range("color.exposure", self.exposure, 0.01, 100.0)?;
        check_range("color.white_k", self.white_k, 1000.0, 15_000.0)?;
        check_range("color.vignetting", self.vignetting, 0.0, 0.9)?;
        check_range("color.shot_variance", self.shot_variance, 0.0, 0.1)?;
        check_range("color.read_sigma", self.read_sigma, 0.0, 0.1)
    }
}

/// Colour camera with its lookup tables for one image size.
#[derive(Debug)]
pub(super) struct ColorCamera {
    response: ColorResponse,
    /// Gain of each channel of a row.
    gains: Vec<f32>,
    losses: Vec<f32>,
    codes: Box<[u8; CODES]>,
    light: Vec<f32>,
    blurred: Vec<f32>,
    size: (usize, usize),
}

impl ColorCamera {
    pub(super) fn new(response: ColorResponse, width: usize, height: usize) -> Self {
        let white = black_body_rgb(response.white_k);
        let half_diagonal_px = (width as f32 / 2.0).hypot(height as f32 / 2.0);
        let full =
            white.map(|w| response.exposure * (CODES - 1) as f32 / (LINEAR_ONE * w.max(0.05)));
        let (mut gains, mut losses) = (vec![], vec![]);
        for column in 0..width {
            let x = (column as f32 + 0.5 - width as f32 / 2.0) / half_diagonal_px;
            gains.extend(full.map(|gain| gain * (1.0 - response.vignetting * x * x)));
            losses.extend(full.map(|gain| gain * response.vignetting));
        }
        Self {
            response,
            light: vec![0.0; gains.len()],
            blurred: vec![0.0; gains.len()],
            gains,
            losses,
            codes: Box::new(std::array::from_fn(code)),
            size: (width, height),
        }
    }

    /// Encodes one row of an image to sRGB bytes.
    pub(super) fn encode_row(
        &mut self,
        image: &[[u16; 3]],
        row: usize,
        noise: (&NoiseKey, &NoiseTables),
        out: &mut [[u8; 3]],
    ) {
        self.gather_light(image, row);
        self.amplify(row);
        if self.response.shot_variance > 0.0 || self.response.read_sigma > 0.0 {
            self.add_noise(row, noise);
        }
        if self.response.is_blurred {
            blur_along_row(&self.light, &mut self.blurred);
            std::mem::swap(&mut self.light, &mut self.blurred);
        }
        for (byte, &light) in out.as_flattened_mut().iter_mut().zip(&self.light) {
            *byte = self.codes[table_index(light)];
        }
    }

    /// Reads the light of a row, blended with its neighbouring rows if the response is blurred.
    fn gather_light(&mut self, image: &[[u16; 3]], row: usize) {
        let (width, height) = self.size;
        let line = |row: usize| image[row * width..(row + 1) * width].as_flattened();
        let here = line(row);
        if !self.response.is_blurred {
            for (light, &value) in self.light.iter_mut().zip(here) {
                *light = f32::from(value);
            }
            return;
        }
        let above = line(row.saturating_sub(1));
        let below = line((row + 1).min(height - 1));
        let rows = above.iter().zip(here).zip(below);
        for (light, ((&a, &h), &b)) in self.light.iter_mut().zip(rows) {
            let sum = i32::from(a) + 2 * i32::from(h) + i32::from(b);
            *light = sum as f32 * 0.25;
        }
    }

    /// Applies exposure, white balance and vignetting to a row.
    fn amplify(&mut self, row: usize) {
        let (width, height) = self.size;
        let half_diagonal_px = (width as f32 / 2.0).hypot(height as f32 / 2.0);
        let y = (row as f32 + 0.5 - height as f32 / 2.0) / half_diagonal_px;
        let y2 = y * y;
        let factors = self.gains.iter().zip(&self.losses);
        for (light, (&gain, &loss)) in self.light.iter_mut().zip(factors) {
            *light = (*light * (gain - loss * y2)).min((CODES - 1) as f32);
        }
    }

    fn add_noise(&mut self, row: usize, (key, tables): (&NoiseKey, &NoiseTables)) {
        let white = (CODES - 1) as f32;
        let shot = self.response.shot_variance * white;
        let read = self.response.read_sigma * white;
        let read_variance = read * read;
        for (block, light) in self.light.chunks_mut(BLOCK).enumerate() {
            let hash = key.hash(NoisePurpose::Color, row, block);
            let normal = tables.normal(hash, light.len());
            for (light, &normal) in light.iter_mut().zip(normal) {
                let sigma = (*light * shot + read_variance).sqrt();
                *light = (*light + sigma * normal).max(0.0).min(white);
            }
        }
    }
}

/// Blurs along the row with the kernel 1:2:1, channel by channel.
fn blur_along_row(light: &[f32], blurred: &mut [f32]) {
    let n = light.len();
    if n < 9 {
        blurred.copy_from_slice(light);
        return;
    }
    let (left, middle, right) = (&light[..n - 6], &light[3..n - 3], &light[6..]);
    let neighbours = left.iter().zip(middle).zip(right);
    for (blurred, ((&l, &m), &r)) in blurred[3..n - 3].iter_mut().zip(neighbours) {
        *blurred = 0.25 * (l + r) + 0.5 * m;
    }
    blurred[..3].copy_from_slice(&light[..3]);
    blurred[n - 3..].copy_from_slice(&light[n - 3..]);
}

/// Table index: the nearest integer to a value from 0 to 4095.
///
/// Adding 2²³ leaves the integer in the lowest bits. A value out of range, which does not occur,
/// would give an arbitrary entry.
#[inline]
fn table_index(light: f32) -> usize {
    (light + 8_388_608.0).to_bits() as usize % CODES
}

/// sRGB encoding of a table index (IEC 61966-2-1).
fn code(index: usize) -> u8 {
    let linear = index as f32 / (CODES - 1) as f32;
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_index_is_the_nearest_integer() {
        for light in [0.0, 0.4, 0.6, 1.4, 2047.51, 4094.6, 4095.0] {
            assert_eq!(table_index(light), light.round() as usize);
        }
    }

    fn encoded(response: ColorResponse, value: [u16; 3]) -> [[u8; 3]; 64] {
        let mut camera = ColorCamera::new(response, 64, 3);
        let image = vec![value; 64 * 3];
        let mut out = [[0; 3]; 64];
        let (key, tables) = (NoiseKey::new(1, 1), NoiseTables::new());
        camera.encode_row(&image, 1, (&key, &tables), &mut out);
        out
    }

    #[test]
    fn white_is_white_and_half_is_188() {
        let one = LINEAR_ONE as u16;
        let white = encoded(ColorResponse::PERFECT, [one; 3])[5];
        assert!(white.iter().all(|&c| c >= 250), "{white:?}");
        let half = encoded(ColorResponse::PERFECT, [one / 2; 3])[5];
        assert!(half.iter().all(|&c| (183..=193).contains(&c)), "{half:?}");
        assert_eq!(encoded(ColorResponse::PERFECT, [u16::MAX; 3])[5], [255; 3]);
    }

    #[test]
    fn the_white_balance_makes_its_own_light_grey() {
        let light = black_body_rgb(3000.0).map(|c| (c * 0.4 * LINEAR_ONE) as u16);
        let response = ColorResponse {
            white_k: 3000.0,
            ..ColorResponse::PERFECT
        };
        let [r, g, b] = encoded(response, light)[5];
        assert!(r.abs_diff(g) <= 1 && g.abs_diff(b) <= 1, "{r} {g} {b}");
    }

    #[test]
    fn noise_and_vignetting_have_an_effect() {
        let response = ColorResponse {
            vignetting: 0.5,
            ..ColorResponse::PERFECT
        };
        let row = encoded(response, [4000; 3]);
        assert!(row[0][0] < row[32][0]);
        let noisy = encoded(ColorResponse::KINECT_V1, [4000; 3]);
        assert!(noisy.windows(2).any(|pair| pair[0] != pair[1]));
    }
}
