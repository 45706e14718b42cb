//! How much of the field of view a cloud covers, and how densely.

use point_cloud::Point;
use random::Random;

/// Greatest tangent of a viewing ray, along the rows and along the columns: a
/// wider view than 150 degrees is no camera's.
const TANGENT_MAX: f32 = 3.8;

/// Depths a camera can measure, metres.
const DEPTH_M: [f32; 2] = [0.05, 100.0];

/// Bins of the histogram of each tangent.
const N_BINS: usize = 2048;

/// One point in so many may lie outside the extent, on each side.
const OUTLIER_DIVISOR: usize = 20_000;

/// About so many points are looked at.
const N_SAMPLES_MAX: usize = 100_000;

/// Cells a side in which the points are counted.
const N_CELLS: usize = 64;

/// Buffers, and the extent measured last.
#[derive(Debug, Default)]
pub(super) struct ViewExtent {
    bins: [Vec<u32>; 2],
    sample: Vec<[f32; 2]>,
    counts: Vec<u32>,
    /// Lowest and highest tangent along rows and along columns.
    pub(super) tangents: [[f32; 2]; 2],
    /// Share of the finite points that a camera at the origin can see.
    pub(super) seen_share: f64,
    /// Mean distance of neighbours, tangent of the angle.
    pub(super) pitch: f64,
    /// Share of the points where the density is about the usual one.
    pub(super) uniform_share: f64,
}

/// The tangents of the ray to a point, for a camera at the origin that looks
/// along z; `None` when it can not see the point.
#[inline]
pub(super) fn tangents_of(point: &Point) -> Option<[f32; 2]> {
    let tangents = [point.x / point.z, point.y / point.z];
    let seen = (DEPTH_M[0]..=DEPTH_M[1]).contains(&point.z)
        && tangents[0].abs() <= TANGENT_MAX
        && tangents[1].abs() <= TANGENT_MAX;
    seen.then_some(tangents)
}

impl ViewExtent {
    /// Tangents of the points looked at.
    pub(super) fn sample(&self) -> &[[f32; 2]] {
        &self.sample
    }

    /// Measures a cloud; `None` when hardly any point can be seen or all lie
    /// on one line of sight.
    pub(super) fn measure(&mut self, points: &[Point]) -> Option<()> {
        let n_drawn = self.draw(points);
        if self.sample.len() < super::N_POINTS_MIN {
            return None;
        }
        self.fill_bins();
        for axis in 0..2 {
            self.tangents[axis] = trimmed(&self.bins[axis], self.sample.len() / OUTLIER_DIVISOR)?;
        }
        self.count_cells(points.len() as f64 / n_drawn as f64)
    }

    /// Draws points, or takes all of few; returns how many.
    fn draw(&mut self, points: &[Point]) -> usize {
        self.sample.clear();
        let n_drawn = points.len().min(N_SAMPLES_MAX);
        let all = n_drawn == points.len();
        // An even step could see every other column only.
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

    /// Counts the points per cell; the usual density is the one at which half
    /// of the points have a denser and half a thinner surrounding. Each point
    /// looked at stands for `n_each`.
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

/// The part of a histogram beyond which at most `n_outliers` points lie.
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
