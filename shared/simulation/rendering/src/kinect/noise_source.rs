//! Random numbers by place, not by order.
//!
//! Tables of numbers are drawn once; where a block of pixels reads in them is
//! a hash of seed, frame, purpose and place. So a pixel's noise does not depend
//! on what else is in the image, and blocks are read at the speed of a copy.

use random::{mixed, unit_f32};

/// Entries at which a block may begin.
const N_STARTS: usize = 1 << 14;
/// Longest block.
pub(super) const BLOCK_MAX: usize = 192;
/// Neighbours that are averaged for the smooth table.
const SMOOTH_WIDTH: usize = 7;

/// What a random number is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    Axial = 1,
    AxialCommon = 2,
    Border = 3,
    BorderCommon = 4,
    Speckle = 5,
    Signal = 6,
    SignalFlicker = 7,
    Color = 8,
}

/// Seed and frame of one image.
#[derive(Debug, Clone, Copy)]
pub(super) struct NoiseKey {
    state: u64,
}

impl NoiseKey {
    pub(super) fn new(seed: u64, frame_index: u64) -> Self {
        Self {
            state: mixed(mixed(seed) ^ frame_index),
        }
    }

    /// A hash that belongs to a place.
    #[inline]
    pub(super) fn hash(&self, purpose: Purpose, row: usize, column: usize) -> u64 {
        let place = (purpose as u64) << 48 | (row as u64) << 24 | column as u64;
        mixed(self.state ^ place.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }
}

/// Tables of random numbers, the same for every sensor.
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

    /// Independent numbers of mean 0 and variance 1.
    #[inline]
    pub(super) fn normal(&self, hash: u64, len: usize) -> &[f32] {
        window(&self.normal, hash, len)
    }

    /// One number of mean 0 and variance 1.
    #[inline]
    pub(super) fn one_normal(&self, hash: u64) -> f32 {
        self.normal[hash as usize % N_STARTS]
    }

    /// Numbers of mean 0 and variance 1 that vary smoothly along the block.
    #[inline]
    pub(super) fn smooth_normal(&self, hash: u64, len: usize) -> &[f32] {
        window(&self.smooth_normal, hash, len)
    }

    /// Numbers evenly spread from 0 to 1 that vary smoothly along the block.
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

/// A nearly normal number: the sum of twelve even ones, which needs no
/// function that differs between platforms.
fn normal_draw(index: u64) -> f32 {
    (0..12)
        .map(|i| unit_f32(mixed(index * 12 + i)))
        .sum::<f32>()
        - 6.0
}

/// Shifted and scaled to mean 0 and variance 1.
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

/// Each value's rank, from 0 to 1.
fn ranks(values: &[f32]) -> Vec<f32> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    for (rank, index) in order.into_iter().enumerate() {
        ranks[index] = (rank as f32 + 0.5) / values.len() as f32;
    }
    ranks
}

/// With the beginning once more at the end, so that no block wraps.
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
    fn places_frames_and_purposes_differ() {
        let key = NoiseKey::new(1, 2);
        let here = key.hash(Purpose::Axial, 3, 4);
        assert_eq!(here, NoiseKey::new(1, 2).hash(Purpose::Axial, 3, 4));
        for other in [
            key.hash(Purpose::Axial, 4, 3),
            key.hash(Purpose::Color, 3, 4),
            NoiseKey::new(1, 3).hash(Purpose::Axial, 3, 4),
            NoiseKey::new(2, 2).hash(Purpose::Axial, 3, 4),
        ] {
            assert_ne!(here, other);
        }
    }
}
