//! Precomputed noise tables with hashed access (counter-based random numbers).
//!
//! The tables are filled once. The position at which a block of pixels reads them is a hash of
//! seed, frame, purpose and pixel position. A pixel's noise is therefore independent of the image
//! contents, and blocks are read at the speed of a copy.

use random::{mix64, unit_f32};

/// Number of positions in a noise table at which a block of values may start.
const N_STARTS: usize = 1 << 14;
/// Greatest length of a block of noise values.
pub(super) const BLOCK_MAX: usize = 192;
/// Width of the moving average of the smooth table. Chosen.
const SMOOTH_WIDTH: usize = 7;

/// Purpose of a random number; separates the noise of the error terms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoisePurpose {
    Axial = 1,
    AxialCommon = 2,
    Border = 3,
    BorderCommon = 4,
    Speckle = 5,
    Signal = 6,
    SignalFlicker = 7,
    Color = 8,
    Matching = 9,
}

/// Noise key of one image: hash of seed and frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct NoiseKey {
    state: u64,
}

impl NoiseKey {
    pub(super) fn new(seed: u64, frame_index: u64) -> Self {
        Self {
            state: mix64(mix64(seed) ^ frame_index),
        }
    }

    /// Hash of the key, a purpose and a pixel position.
    #[inline]
    pub(super) fn hash(&self, purpose: NoisePurpose, row: usize, column: usize) -> u64 {
        let place = (purpose as u64) << 48 | (row as u64) << 24 | column as u64;
        mix64(self.state ^ place.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }
}

/// Noise tables, the same for every sensor.
#[derive(Debug)]
pub(super) struct NoiseTables {
    normal: Vec<f32>,
    smooth_normal: Vec<f32>,
    smooth_uniform: Vec<f32>,
}

impl NoiseTables {
    pub(super) fn new() -> Self {
        let draws: Vec<f32> = (0..N_STARTS).map(|i| normal_draw(i as u64)).collect();
        let normal = standardised(draws);
        let averaged = (0..N_STARTS)
            .map(|i| (0..SMOOTH_WIDTH).map(|j| normal[(i + j) % N_STARTS]).sum())
            .collect();
        let smooth_normal = standardised(averaged);
        Self {
            smooth_uniform: extended(&ranks(&smooth_normal)),
            normal: extended(&normal),
            smooth_normal: extended(&smooth_normal),
        }
    }

    /// Independent normal values (mean 0, variance 1).
    #[inline]
    pub(super) fn normal(&self, hash: u64, len: usize) -> &[f32] {
        window(&self.normal, hash, len)
    }

    /// Single normal value (mean 0, variance 1).
    #[inline]
    pub(super) fn one_normal(&self, hash: u64) -> f32 {
        self.normal[hash as usize % N_STARTS]
    }

    /// Normal values (mean 0, variance 1) that vary smoothly along the block.
    #[inline]
    pub(super) fn smooth_normal(&self, hash: u64, len: usize) -> &[f32] {
        window(&self.smooth_normal, hash, len)
    }

    /// Uniform values from 0 to 1 that vary smoothly along the block.
    #[inline]
    pub(super) fn smooth_uniform(&self, hash: u64, len: usize) -> &[f32] {
        window(&self.smooth_uniform, hash, len)
    }
}

#[inline]
fn window(table: &[f32], hash: u64, len: usize) -> &[f32] {
    let start = hash as usize % N_STARTS;
    &table[start..start + len.min(BLOCK_MAX)]
}

/// Approximately normal value: the sum of twelve uniform ones (Irwin–Hall), which needs no
/// function that differs between platforms.
fn normal_draw(index: u64) -> f32 {
    (0..12)
        .map(|i| unit_f32(mix64(index * 12 + i)))
        .sum::<f32>()
        - 6.0
}

/// Standardises values to mean 0 and variance 1.
fn standardised(mut values: Vec<f32>) -> Vec<f32> {
    let n = values.len() as f64;
    let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
    let variance = values
        .iter()
        .map(|&v| (f64::from(v) - mean).powi(2))
        .sum::<f64>()
        / n;
    let scale = 1.0 / variance.sqrt();
    for value in &mut values {
        *value = ((f64::from(*value) - mean) * scale) as f32;
    }
    values
}

/// Rank transform of the values to 0 to 1.
fn ranks(values: &[f32]) -> Vec<f32> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    for (rank, index) in order.into_iter().enumerate() {
        ranks[index] = (rank as f32 + 0.5) / values.len() as f32;
    }
    ranks
}

/// Appends the start of the table at its end, so that no block wraps around.
fn extended(values: &[f32]) -> Vec<f32> {
    values.iter().chain(&values[..BLOCK_MAX]).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_mean_0_and_variance_1() {
        let tables = NoiseTables::new();
        for table in [&tables.normal, &tables.smooth_normal] {
            let n = N_STARTS as f32;
            let mean = table[..N_STARTS].iter().sum::<f32>() / n;
            let variance = table[..N_STARTS].iter().map(|v| v * v).sum::<f32>() / n;
            assert!(mean.abs() < 1e-3 && (variance - 1.0).abs() < 1e-3);
        }
        let below = tables.smooth_uniform[..N_STARTS]
            .iter()
            .filter(|&&u| u < 0.3)
            .count();
        assert!((below as f32 / N_STARTS as f32 - 0.3).abs() < 1e-3);
    }

    #[test]
    fn hashes_differ_by_position_frame_and_purpose() {
        let key = NoiseKey::new(1, 2);
        let here = key.hash(NoisePurpose::Axial, 3, 4);
        assert_eq!(here, NoiseKey::new(1, 2).hash(NoisePurpose::Axial, 3, 4));
        for other in [
            key.hash(NoisePurpose::Axial, 4, 3),
            key.hash(NoisePurpose::Color, 3, 4),
            NoiseKey::new(1, 3).hash(NoisePurpose::Axial, 3, 4),
            NoiseKey::new(2, 2).hash(NoisePurpose::Axial, 3, 4),
        ] {
            assert_ne!(here, other);
        }
    }
}
