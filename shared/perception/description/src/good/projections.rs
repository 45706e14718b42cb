//! Orthographic projection histograms of a point set.

use super::bins::Bins;
use crate::projected_points::{LANES, ProjectedPoints};

/// Histograms of the projections (y, z), (x, z) and (x, y), each `n x n`, row-major; the
/// first coordinate is the row.
#[derive(Debug, Clone)]
pub(super) struct Projections {
    n_bins: usize,
    /// Counts, `(n + 1) x (n + 1)` per projection: the last row and column collect
    /// points outside the support, which avoids a branch per point.
    counts: Vec<u32>,
    shares: Vec<f32>,
}

impl Projections {
    /// Empty histograms with `n_bins` bins per side.
    pub(super) fn new(n_bins: usize) -> Self {
        Self {
            n_bins,
            counts: vec![0; 3 * (n_bins + 1) * (n_bins + 1)],
            shares: vec![0.0; 3 * n_bins * n_bins],
        }
    }

    /// Counts the points in the bins; x and y are multiplied by `sign`, z is not.
    pub(super) fn fill(&mut self, points: &ProjectedPoints, sign: f32, bins: Bins) {
        self.count(points, sign, bins);
        let (n, stride) = (self.n_bins, self.n_bins + 1);
        for (counts, shares) in self
            .counts
            .chunks_exact(stride * stride)
            .zip(self.shares.chunks_exact_mut(n * n))
        {
            let rows = || counts.chunks_exact(stride).map(|row| &row[..n]).take(n);
            let counted = rows().flatten().sum::<u32>().max(1) as f32;
            for (shares, counts) in shares.chunks_exact_mut(n).zip(rows()) {
                for (share, &count) in shares.iter_mut().zip(counts) {
                    *share = count as f32 / counted;
                }
            }
        }
    }

    /// Normalised histograms of (y, z), (x, z) and (x, y).
    pub(super) fn parts(&self) -> [&[f32]; 3] {
        let n_cells = self.n_bins * self.n_bins;
        let (yz, rest) = self.shares.split_at(n_cells);
        let (xz, xy) = rest.split_at(n_cells);
        [yz, xz, xy]
    }

    fn count(&mut self, points: &ProjectedPoints, sign: f32, bins: Bins) {
        self.counts.fill(0);
        let stride = self.n_bins + 1;
        let (yz, rest) = self.counts.split_at_mut(stride * stride);
        let (xz, xy) = rest.split_at_mut(stride * stride);
        for block in points.blocks() {
            let [x, y, z] = bins.indices(block, sign);
            for i in 0..LANES {
                let (x, y, z) = (x[i] as usize, y[i] as usize, z[i] as usize);
                yz[y * stride + z] += 1;
                xz[x * stride + z] += 1;
                xy[x * stride + y] += 1;
            }
        }
    }
}
