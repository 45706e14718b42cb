//! Edge image: strength of the boundary between each two neighbouring cells.

use super::bends::Bends;
use super::cell_image::{CellImage, MARGIN};
use super::edge_features::{BLOCK, EdgeLines};
use super::edge_network::log_odds;
use crate::parallelism::{Parallelism, for_each};
use sensor_noise::DepthNoise;

/// Strength between places that are not two cells.
pub(crate) const NO_EDGE: u8 = u8::MAX;

/// Greatest strength of an edge.
const STRENGTH_MAX: u8 = 240;

/// Log odds of the greatest strength; those of strength 0 are its negative.
const LOG_ODDS_MAX: f32 = 6.0;

/// Strength of an edge with given log odds of a boundary.
#[inline]
fn strength(log_odds: f32) -> u8 {
    let share = (log_odds + LOG_ODDS_MAX) / (2.0 * LOG_ODDS_MAX);
    (share.clamp(0.0, 1.0) * f32::from(STRENGTH_MAX)) as u8
}

/// Log odds of a boundary at an edge of a given strength.
#[inline]
pub(crate) fn log_odds_of(strength: u8) -> f32 {
    LOG_ODDS_MAX * (2.0 * f32::from(strength) / f32::from(STRENGTH_MAX) - 1.0)
}

/// Strength of the edges of a cell image. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct EdgeImage {
    /// Strength of the edge from each place to the next one in its row, and in its column.
    pub(crate) to_next: [Vec<u8>; 2],
}

impl EdgeImage {
    /// Evaluate the edges of an image whose cells are `pitch` wide, metres at 1 m, but for those
    /// within a cluster that `is_whole`.
    pub(crate) fn refill(
        &mut self,
        (image, is_whole): (&CellImage, &[bool]),
        bends: &Bends,
        pitch: f32,
        noise: DepthNoise,
        parallelism: &dyn Parallelism,
    ) {
        for strengths in &mut self.to_next {
            strengths.clear();
            strengths.resize(image.n_places(), NO_EDGE);
        }
        let lines = EdgeLines::of(image, bends, pitch, noise);
        let [to_right, to_below] = &mut self.to_next;
        let rows = to_right.chunks_mut(image.width);
        let rows = rows.zip(to_below.chunks_mut(image.width)).enumerate();
        let rows = rows.skip(MARGIN).take(image.height - 2 * MARGIN);
        for_each(parallelism, rows, |(row, (to_right, to_below))| {
            for column in (MARGIN..image.width - MARGIN).step_by(BLOCK) {
                let first = row * image.width + column;
                for (lines, strengths) in lines.iter().zip([&mut *to_right, &mut *to_below]) {
                    evaluate(lines, first, is_whole, &mut strengths[column..]);
                }
            }
        });
    }
}

/// Write the strengths of the edges from a block of places, or of its part that is left in the
/// row.
#[inline]
fn evaluate(lines: &EdgeLines<'_>, first: usize, is_whole: &[bool], strengths: &mut [u8]) {
    let mask = lines.mask(first, is_whole);
    if mask.contains(&true) {
        let log_odds = log_odds(&lines.features(first));
        for ((place, is_edge), log_odds) in strengths.iter_mut().zip(mask).zip(log_odds) {
            if is_edge {
                *place = strength(log_odds);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strength_follows_the_log_odds() {
        for log_odds in [-6.0, -3.3, 0.0, 2.0, 6.0] {
            assert!((log_odds_of(strength(log_odds)) - log_odds).abs() < 0.06);
        }
        assert_eq!([strength(-9.0), strength(f32::INFINITY)], [0, STRENGTH_MAX]);
    }
}
