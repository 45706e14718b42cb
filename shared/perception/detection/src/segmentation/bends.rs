//! Bends of the surface along the rows and columns of the cell image: concave where one object
//! stands on or against another, convex at the edges of an object.

use super::cell_image::{CellImage, MARGIN};
use sensor_noise::DepthNoise;
use std::ops::Range;

/// Target standard deviation of a bend, metres per metre; it sets the length of the arms. Chosen.
const SLOPE_SIGMA: f32 = 0.14;

/// Least and greatest length of an arm, cells. Chosen.
const ARM_CELLS: [usize; 2] = [2, 12];

/// Ratio of the noise of a cell to that of a pixel, whose noise is correlated with that of its
/// neighbours. Chosen.
const CELL_NOISE: f32 = 0.6;

/// Greatest step of inverse depth between neighbours on one surface, 1/metre: about the depth
/// step at 1 m, growing with squared depth. Chosen.
const STEP: f32 = 0.016;

/// Bends at each place of a cell image, metres per metre on either side, concave positive; NaN
/// where none is measured. Reused from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Bends {
    pub(crate) along_row: Vec<f32>,
    pub(crate) along_column: Vec<f32>,
    run: Vec<f32>,
    fit: BendFit,
}

impl Bends {
    /// Measure the bends of an image whose cells are `pitch` wide, metres at 1 m.
    pub(crate) fn refill(&mut self, image: &CellImage, pitch: f32, noise: &DepthNoise) {
        let Self {
            along_row,
            along_column,
            run,
            fit,
        } = self;
        for bends in [&mut *along_row, &mut *along_column] {
            bends.clear();
            bends.resize(image.n_places(), f32::NAN);
        }
        let (width, height) = (image.width, image.height);
        for row in MARGIN..height - MARGIN {
            let line = Line {
                first: row * width,
                step: 1,
                n: width,
            };
            line.visit_surfaces(&image.inverse_depth, run, |first, surface| {
                let bends = fit.bends(surface, pitch, noise);
                along_row[first..first + bends.len()].copy_from_slice(bends);
            });
        }
        for column in MARGIN..width - MARGIN {
            let line = Line {
                first: column,
                step: width,
                n: height,
            };
            line.visit_surfaces(&image.inverse_depth, run, |first, surface| {
                let places = along_column[first..].iter_mut().step_by(width);
                for (place, bend) in places.zip(fit.bends(surface, pitch, noise)) {
                    *place = *bend;
                }
            });
        }
    }
}

/// Row or column of an image: its first place, the distance of neighbours and their number.
struct Line {
    first: usize,
    step: usize,
    n: usize,
}

impl Line {
    /// Visit the runs of cells without a depth step that are long enough for a bend, each with
    /// its first place and its inverse depths.
    fn visit_surfaces(
        &self,
        inverse_depth: &[f32],
        run: &mut Vec<f32>,
        mut visit: impl FnMut(usize, &[f32]),
    ) {
        run.clear();
        let (mut first, mut previous) = (self.first, 0.0_f32);
        for place in (self.first..).step_by(self.step).take(self.n) {
            let own = inverse_depth[place];
            if own <= 0.0 || (own - previous).abs() > STEP {
                if run.len() > 2 * ARM_CELLS[0] {
                    visit(first, run);
                }
                run.clear();
                first = place;
            }
            if own > 0.0 {
                run.push(own);
            }
            previous = own;
        }
    }
}

/// Least-squares fit of a line plus a symmetric bend to the inverse depth around each cell. The
/// inverse depth of a plane is linear in the image.
#[derive(Debug, Default)]
struct BendFit {
    /// Prefix sums of the inverse depth and of its product with the index, which make the
    /// cost independent of the arm length. Double precision: in a long run the second sum is
    /// much larger than the change by a bend.
    sums: [Vec<f64>; 2],
    bends: Vec<f32>,
}

impl BendFit {
    /// Bend at each cell of a run, metres per metre; NaN where the arms would be too short.
    fn bends(&mut self, run: &[f32], pitch: f32, noise: &DepthNoise) -> &[f32] {
        self.accumulate(run);
        let n = run.len();
        self.bends.clear();
        self.bends.resize(n, f32::NAN);
        let arm = arm_cells(1.0 / run[0], pitch, noise).min((n - 1) / 2);
        for short in ARM_CELLS[0]..arm {
            self.fit(short..short + 1, short);
            self.fit(n - 1 - short..n - short, short);
        }
        self.fit(arm..n - arm, arm);
        for (bend, inverse_depth) in self.bends.iter_mut().zip(run) {
            *bend /= inverse_depth * pitch;
        }
        &self.bends
    }

    fn accumulate(&mut self, run: &[f32]) {
        let [plain, weighted] = &mut self.sums;
        for sums in [&mut *plain, &mut *weighted] {
            sums.clear();
            sums.resize(run.len() + 1, 0.0);
        }
        let mut sum = [0.0; 2];
        let sums = plain[1..].iter_mut().zip(&mut weighted[1..]);
        for ((i, inverse_depth), (plain, weighted)) in run.iter().enumerate().zip(sums) {
            let inverse_depth = f64::from(*inverse_depth);
            sum[0] += inverse_depth;
            sum[1] += i as f64 * inverse_depth;
            (*plain, *weighted) = (sum[0], sum[1]);
        }
    }

    /// Fit the bend at a range of cells with a given arm length. Branch-free, so that the
    /// compiler vectorises it.
    fn fit(&mut self, cells: Range<usize>, arm: usize) {
        let (first, n) = (cells.start, cells.len());
        let arms = Arms::new(arm);
        let [p, w] = self.sums.each_ref().map(|sums| {
            let ends = arms.ends(first);
            ends.map(|end| &sums[end..end + n])
        });
        let bends = &mut self.bends[cells];
        for i in 0..n {
            let ends = [p, w].map(|sums| sums.map(|sums| sums[i]));
            bends[i] = arms.bend((first + i) as f64, ends);
        }
    }
}

/// Arms on either side of a cell, of the same length.
struct Arms {
    n: usize,
    /// Mean of the distance |j| from the cell over both arms.
    mean: f64,
    /// Sum of (|j| - mean)² over both arms.
    spread: f64,
}

impl Arms {
    fn new(n: usize) -> Self {
        let length = n as f64;
        Self {
            n,
            mean: 0.5 * (length + 1.0),
            spread: length * (length * length - 1.0) / 6.0,
        }
    }

    /// Start and end of the left and of the right arm of a cell in the prefix sums.
    #[inline]
    fn ends(&self, cell: usize) -> [usize; 4] {
        [cell - self.n, cell, cell + 1, cell + self.n + 1]
    }

    /// Change of slope at a cell from the prefix sums `p` and the weighted ones `w` at the ends
    /// of its arms.
    #[inline]
    fn bend(&self, at: f64, [p, w]: [[f64; 4]; 2]) -> f32 {
        let (left, right) = (p[1] - p[0], p[3] - p[2]);
        // Sum of |j| w and of w over both arms, without the cell itself.
        let weighted = (w[3] - w[2]) - at * right + at * left - (w[1] - w[0]);
        ((weighted - self.mean * (right + left)) / self.spread) as f32
    }
}

/// Arm length at a depth, cells. The bend over n cells on either side has the noise of one cell
/// divided by the square root of n³ / 6.
fn arm_cells(depth_m: f32, pitch: f32, noise: &DepthNoise) -> usize {
    let noise_in_cells = CELL_NOISE * noise.sigma_m(depth_m) / (depth_m * pitch);
    let cubed = 6.0 * (noise_in_cells / SLOPE_SIGMA).powi(2);
    (cubed.cbrt() as usize).clamp(ARM_CELLS[0], ARM_CELLS[1])
}

#[cfg(test)]
mod tests;
