//! The three histograms of a point set.

use super::projected_points::ProjectedPoints;

/// Histograms of the projections (y, z), (x, z) and (x, y), each `n x n`,
/// row-major, the first coordinate choosing the row.
#[derive(Debug, Clone)]
pub(super) struct Projections {
    n_bins: usize,
    counts: Vec<u32>,
    shares: Vec<f32>,
}

/// Bins of equal width along one axis.
#[derive(Debug, Clone, Copy)]
struct Bins {
    n: u32,
    half_support_m: f64,
    width_m: f64,
}

impl Bins {
    /// The bin of a coordinate, `n` when it lies in none. As published: the shifted
    /// coordinate is rounded to single precision, and since truncation goes towards
    /// zero, the first bin reaches back by one width.
    #[inline]
    fn of(self, coordinate_m: f32) -> u32 {
        let shifted = (f64::from(coordinate_m) + self.half_support_m) as f32;
        let bin = (f64::from(shifted) / self.width_m) as i32 as u32;
        bin.min(self.n)
    }
}

impl Projections {
    /// Empty histograms of `n_bins` a side.
    pub(super) fn new(n_bins: usize) -> Self {
        let n_cells = 3 * n_bins * n_bins;
        Self {
            n_bins,
            counts: vec![0; n_cells],
            shares: vec![0.0; n_cells],
        }
    }

    /// Counts the points in a cube of `support_m` a side around the origin; x and y
    /// are multiplied by `sign`, z never is.
    pub(super) fn fill(&mut self, points: &ProjectedPoints, sign: f32, support_m: f64) {
        self.count(points, sign, support_m);
        let n_cells = self.n_bins * self.n_bins;
        for (counts, shares) in self
            .counts
            .chunks_exact(n_cells)
            .zip(self.shares.chunks_exact_mut(n_cells))
        {
            let counted = counts.iter().sum::<u32>().max(1) as f32;
            for (share, &count) in shares.iter_mut().zip(counts) {
                *share = count as f32 / counted;
            }
        }
    }

    /// Shares of the counted points in the bins of (y, z), (x, z) and (x, y).
    pub(super) fn parts(&self) -> [&[f32]; 3] {
        let n_cells = self.n_bins * self.n_bins;
        let (yz, rest) = self.shares.split_at(n_cells);
        let (xz, xy) = rest.split_at(n_cells);
        [yz, xz, xy]
    }

    fn count(&mut self, points: &ProjectedPoints, sign: f32, support_m: f64) {
        let n = self.n_bins as u32;
        let bins = Bins {
            n,
            half_support_m: support_m / 2.0,
            width_m: support_m / f64::from(n),
        };
        self.counts.fill(0);
        let n_cells = self.n_bins * self.n_bins;
        let (yz, rest) = self.counts.split_at_mut(n_cells);
        let (xz, xy) = rest.split_at_mut(n_cells);
        for ((&x, &y), &z) in points.x.iter().zip(&points.y).zip(&points.z) {
            let (x, y, z) = (bins.of(sign * x), bins.of(sign * y), bins.of(z));
            add(yz, y, z, n);
            add(xz, x, z, n);
            add(xy, x, y, n);
        }
    }
}

#[inline]
fn add(counts: &mut [u32], row: u32, column: u32, n: u32) {
    if row < n && column < n {
        counts[(row * n + column) as usize] += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_are_half_open_and_the_first_reaches_back() {
        let bins = Bins {
            n: 4,
            half_support_m: 2.0,
            width_m: 1.0,
        };
        for (coordinate, bin) in [
            (-2.0, 0),
            (-1.001, 0),
            (-1.0, 1),
            (1.999, 3),
            (2.0, 4),
            (-2.999, 0),
            (-3.0, 4),
            (99.0, 4),
        ] {
            assert_eq!(bins.of(coordinate), bin, "{coordinate}");
        }
    }
}
