//! View extent: angular bounds, density and uniformity of a cloud seen from its origin.

use point_cloud::Point;
use random::Random;

/// Least number of usable points of a view. Chosen.
const N_POINTS_MIN: usize = 64;

/// Greatest tangent of a viewing ray along rows and columns; no camera's view is wider than
/// 150 degrees.
const TANGENT_MAX: f32 = 3.8;

/// Depth range of a camera, metres.
const DEPTH_M: [f32; 2] = [0.05, 100.0];

/// Number of histogram bins per tangent.
const N_BINS: usize = 2048;

/// Reciprocal of the outlier share trimmed on each side of the extent. Chosen.
const OUTLIER_DIVISOR: usize = 20_000;

/// Greatest number of sampled points.
const N_SAMPLES_MAX: usize = 100_000;

/// Number of density cells per side.
const N_CELLS: usize = 64;

/// View extent measured last, with buffers.
#[derive(Debug, Default)]
pub(super) struct ViewExtent {
    bins: [Vec<u32>; 2],
    sample: Vec<[f32; 2]>,
    counts: Vec<u32>,
    /// Least and greatest tangent along rows and along columns.
    pub(super) tangents: [[f32; 2]; 2],
    /// Share of the finite points that a camera at the origin can see.
    pub(super) seen_share: f64,
    /// Mean point spacing, tangent of the angle.
    pub(super) pitch: f64,
    /// Share of the points at about the median density.
    pub(super) uniform_share: f64,
}

/// Tangents of the ray to a point, for a camera at the origin along z; `None` when it
/// cannot see the point.
#[inline]
pub(super) fn tangents_of(point: &Point) -> Option<[f32; 2]> {
    let tangents = [point.x / point.z, point.y / point.z];
    let seen = (DEPTH_M[0]..=DEPTH_M[1]).contains(&point.z)
        && tangents[0].abs() <= TANGENT_MAX
        && tangents[1].abs() <= TANGENT_MAX;
    seen.then_some(tangents)
}

impl ViewExtent {
    /// Viewing-angle tangents of the sampled points.
    pub(super) fn sample(&self) -> &[[f32; 2]] {
        &self.sample
    }

    /// Measure a cloud; `None` when too few points are visible or all are on one ray.
    pub(super) fn measure(&mut self, points: &[Point]) -> Option<()> {
        let n_drawn = self.draw(points);
        if self.sample.len() < N_POINTS_MIN {
            return None;
        }
        self.fill_bins();
        for axis in 0..2 {
            self.tangents[axis] = trimmed(&self.bins[axis], self.sample.len() / OUTLIER_DIVISOR)?;
        }
        self.count_cells(points.len() as f64 / n_drawn as f64)
    }

    /// Sample the points, all of them if few; returns their number.
    fn draw(&mut self, points: &[Point]) -> usize {
        self.sample.clear();
        let n_drawn = points.len().min(N_SAMPLES_MAX);
        let all = n_drawn == points.len();
        // A fixed stride could hit every other column only.
        let mut random = Random::from_seed(points.len() as u64);
        let mut n_finite = 0;
        for i in 0..n_drawn {
            let point = &points[if all { i } else { random.below(points.len()) }];
            n_finite += usize::from(point.is_finite());
            self.sample.extend(tangents_of(point));
        }
        self.seen_share = self.sample.len() as f64 / n_finite.max(1) as f64;
        n_drawn
    }

    fn fill_bins(&mut self) {
        for (axis, bins) in self.bins.iter_mut().enumerate() {
            bins.clear();
            bins.resize(N_BINS, 0);
            for tangents in &self.sample {
                bins[bin_of(tangents[axis])] += 1;
            }
        }
    }

    /// Density per cell. The usual density is the median over points; each sampled point
    /// stands for `n_each`.
    fn count_cells(&mut self, n_each: f64) -> Option<()> {
        let [columns, rows] = self.tangents;
        let per = |[low, high]: [f32; 2]| N_CELLS as f32 / (high - low);
        let (per_u, per_v) = (per(columns), per(rows));
        self.counts.clear();
        self.counts.resize(N_CELLS * N_CELLS, 0);
        for &[u, v] in &self.sample {
            let (u, v) = ((u - columns[0]) * per_u, (v - rows[0]) * per_v);
            let inside = 0.0..N_CELLS as f32;
            if inside.contains(&u) && inside.contains(&v) {
                self.counts[v as usize * N_CELLS + u as usize] += 1;
            }
        }
        self.counts.retain(|&count| count > 0);
        self.counts.sort_unstable();
        let total: u64 = self.counts.iter().map(|&count| u64::from(count)).sum();
        let mut below = 0;
        let usual = *self.counts.iter().find(|&&count| {
            below += u64::from(count);
            2 * below >= total
        })?;
        let even = self
            .counts
            .iter()
            .filter(|&&count| 2 * count >= usual && count <= 2 * usual);
        self.uniform_share = even.map(|&count| f64::from(count)).sum::<f64>() / total as f64;
        let usual = n_each * f64::from(usual);
        self.pitch = (1.0 / (f64::from(per_u) * f64::from(per_v) * usual)).sqrt();
        Some(())
    }
}

#[inline]
fn bin_of(tangent: f32) -> usize {
    let bin = (tangent + TANGENT_MAX) * (N_BINS as f32 / (2.0 * TANGENT_MAX));
    (bin as usize).min(N_BINS - 1)
}

/// Range of a histogram without at most `n_outliers` points at each end.
fn trimmed(bins: &[u32], n_outliers: usize) -> Option<[f32; 2]> {
    let beyond = |bins: &mut dyn Iterator<Item = &u32>| {
        let mut n = 0;
        bins.take_while(|&&count| {
            n += count as usize;
            n <= n_outliers
        })
        .count()
    };
    let low = beyond(&mut bins.iter());
    let high = N_BINS - beyond(&mut bins.iter().rev());
    let edge = |bin: usize| bin as f32 * (2.0 * TANGENT_MAX / N_BINS as f32) - TANGENT_MAX;
    (low < high).then(|| [edge(low.saturating_sub(1)), edge((high + 1).min(N_BINS))])
}
