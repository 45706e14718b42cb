//! Concave crease detection: lines along which one object stands on or against another.

use crate::patch::{Patch, PatchPixel};
use sensor_noise::DepthNoise;
use std::ops::Range;

/// Approximate field of view of the image width, radians. The cloud does not state it; the
/// crease measure is proportional to it. Chosen; sensitivity: see `tabula-lab sweep`.
const IMAGE_WIDTH_RAD: f32 = 1.09;

/// Target standard deviation of a crease's slope, metres per metre; it sets the arm length.
/// Chosen; sensitivity: see `tabula-lab sweep`.
const SLOPE_SIGMA: f32 = 0.14;

/// Least and greatest arm length of a crease, pixels. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const ARM_PX: [usize; 2] = [4, 24];

/// Least slope of a concave crease, metres per metre across the line of sight on either
/// side. Chosen; sensitivity: see `tabula-lab sweep`.
const SLOPE_MIN: f32 = 0.4;

/// Greatest depth step between neighbours on one surface, metres at 1 m; grows with squared
/// depth. Chosen; sensitivity: see `tabula-lab sweep`.
const STEP_M: f32 = 0.012;

/// Dilation of a crease along its line, pixels on either side, so that its ends leave no
/// gap. Chosen; sensitivity: see `tabula-lab sweep`.
const DILATION_PX: usize = 2;

/// Least number of crease pixels in a cluster to be split. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const CREASE_PIXELS_MIN: usize = 30;

/// Image creases found last, with buffers.
#[derive(Debug, Default)]
pub(crate) struct Creases {
    /// Per patch index: `true` on a crease.
    pub(crate) is_crease: Vec<bool>,
    /// Per patch index: the stronger signed bend of its row and its column, metres per
    /// metre, concave positive; NaN without a measurement.
    pub(crate) bend: Vec<f32>,
    by_column: Vec<PatchPixel>,
    next_in_column: Vec<u32>,
    fit: BendFit,
}

impl Creases {
    /// Mark the concave creases of a cluster along rows and columns of an image of width
    /// `image_width`, pixels. Returns `true` when there are enough to split it.
    pub(crate) fn find(&mut self, patch: &Patch, image_width: usize, noise: &DepthNoise) -> bool {
        self.is_crease.clear();
        self.is_crease.resize(patch.part_of.len(), false);
        self.bend.clear();
        self.bend.resize(patch.part_of.len(), f32::NAN);
        let pixel_rad = IMAGE_WIDTH_RAD / image_width as f32;
        self.sort_by_column(patch);
        let Self {
            is_crease,
            bend,
            by_column,
            fit,
            ..
        } = self;
        let mut mark = |surface: &[PatchPixel]| {
            if surface.len() > 2 * ARM_PX[0] {
                let bends = fit.bends(surface, pixel_rad, noise);
                mark_surface(surface, bends, is_crease, bend);
            }
        };
        let is_near = |a: &PatchPixel, b: &PatchPixel| (a.z - b.z).abs() <= STEP_M * a.z * a.z;
        let rows = &patch.pixels;
        rows.chunk_by(|a, b| a.row == b.row && is_near(a, b))
            .for_each(&mut mark);
        by_column
            .chunk_by(|a, b| a.column == b.column && is_near(a, b))
            .for_each(&mut mark);
        let n_marked = rows.iter().filter(|pixel| is_crease[pixel.index as usize]);
        n_marked.count() >= CREASE_PIXELS_MIN
    }

    /// Counting sort of the pixels from row-major to column-major order.
    fn sort_by_column(&mut self, patch: &Patch) {
        let Self {
            by_column,
            next_in_column,
            ..
        } = self;
        next_in_column.clear();
        next_in_column.resize(patch.width + 1, 0);
        for pixel in &patch.pixels {
            next_in_column[pixel.column as usize + 1] += 1;
        }
        for column in 0..patch.width {
            next_in_column[column + 1] += next_in_column[column];
        }
        by_column.clear();
        by_column.resize(patch.pixels.len(), PatchPixel::default());
        for pixel in &patch.pixels {
            let next = &mut next_in_column[pixel.column as usize];
            by_column[*next as usize] = *pixel;
            *next += 1;
        }
    }
}

/// Record the bends of one surface and mark its concave creases.
fn mark_surface(
    surface: &[PatchPixel],
    bends: &[f32],
    is_crease: &mut [bool],
    strongest: &mut [f32],
) {
    for (i, (pixel, &bend)) in surface.iter().zip(bends).enumerate() {
        let stronger = &mut strongest[pixel.index as usize];
        *stronger = stronger.max(bend);
        if bend >= SLOPE_MIN {
            let wide = i.saturating_sub(DILATION_PX)..surface.len().min(i + DILATION_PX + 1);
            for near in &surface[wide] {
                is_crease[near.index as usize] = true;
            }
        }
    }
}

/// Least-squares fit of a line plus a symmetric bend to the inverse depth around each
/// pixel. The inverse depth of a plane is linear in the image.
#[derive(Debug, Default)]
struct BendFit {
    /// Prefix sums of the inverse depth and of its product with the index, which make the
    /// cost independent of the arm length. Double precision: in a long row the second sum
    /// is much larger than the change by a bend.
    sums: [Vec<f64>; 2],
    bends: Vec<f32>,
}

impl BendFit {
    /// Signed bend at each pixel, metres per metre; NaN where the arms would be too short.
    fn bends(&mut self, surface: &[PatchPixel], pixel_rad: f32, noise: &DepthNoise) -> &[f32] {
        self.accumulate(surface);
        let n = surface.len();
        self.bends.clear();
        self.bends.resize(n, f32::NAN);
        let most = (n - 1) / 2;
        let arm = arm_px(surface[0].z, pixel_rad, noise).min(most);
        for short in ARM_PX[0]..arm {
            self.fit_bend(short, short);
            self.fit_bend(n - 1 - short, short);
        }
        self.fit_bends(arm..n - arm, arm);
        for (bend, pixel) in self.bends.iter_mut().zip(surface) {
            *bend = *bend * pixel.z / pixel_rad;
        }
        &self.bends
    }

    fn accumulate(&mut self, surface: &[PatchPixel]) {
        let [plain, weighted] = &mut self.sums;
        for sums in [&mut *plain, &mut *weighted] {
            sums.clear();
            sums.resize(surface.len() + 1, 0.0);
        }
        let mut sum = [0.0; 2];
        let sums = plain[1..].iter_mut().zip(&mut weighted[1..]);
        for ((i, pixel), (plain, weighted)) in surface.iter().enumerate().zip(sums) {
            let inverse_depth = f64::from(1.0 / pixel.z);
            sum[0] += inverse_depth;
            sum[1] += i as f64 * inverse_depth;
            (*plain, *weighted) = (sum[0], sum[1]);
        }
    }

    /// Fit the bend at a range of pixels with a given arm length. Branch-free, so that the
    /// compiler vectorises it.
    fn fit_bends(&mut self, pixels: Range<usize>, arm: usize) {
        let (first, n) = (pixels.start, pixels.len());
        let arms = Arms::new(arm);
        let [p, w] = self.sums.each_ref().map(|sums| {
            let ends = arms.ends(first);
            ends.map(|end| &sums[end..end + n])
        });
        let bends = &mut self.bends[pixels];
        for i in 0..n {
            let ends = [p, w].map(|sums| sums.map(|sums| sums[i]));
            bends[i] = arms.bend((first + i) as f64, ends);
        }
    }

    /// Fit the bend at one pixel with a given arm length.
    fn fit_bend(&mut self, pixel: usize, arm: usize) {
        let arms = Arms::new(arm);
        let ends = arms.ends(pixel);
        let ends = self.sums.each_ref().map(|sums| ends.map(|end| sums[end]));
        self.bends[pixel] = arms.bend(pixel as f64, ends);
    }
}

/// Arms on either side of a pixel, of the same length.
struct Arms {
    length_px: usize,
    /// Mean of the distance |j| from the pixel over both arms.
    mean: f64,
    /// Sum of (|j| - mean)² over both arms.
    spread: f64,
}

impl Arms {
    fn new(length_px: usize) -> Self {
        let arm = length_px as f64;
        Self {
            length_px,
            mean: 0.5 * (arm + 1.0),
            spread: arm * ((length_px * length_px) as f64 - 1.0) / 6.0,
        }
    }

    /// Start and end of the left and of the right arm of a pixel in the prefix sums.
    #[inline]
    fn ends(&self, pixel: usize) -> [usize; 4] {
        let arm = self.length_px;
        [pixel - arm, pixel, pixel + 1, pixel + arm + 1]
    }

    /// Bend at a pixel from the prefix sums `p` and the weighted ones `w` at the ends of its
    /// arms.
    #[inline]
    fn bend(&self, at: f64, [p, w]: [[f64; 4]; 2]) -> f32 {
        let (left, right) = (p[1] - p[0], p[3] - p[2]);
        // Sum of |j| w and of w over both arms, without the pixel itself.
        let weighted = (w[3] - w[2]) - at * right + at * left - (w[1] - w[0]);
        ((weighted - self.mean * (right + left)) / self.spread) as f32
    }
}

/// Arm length of a crease at a depth, pixels. The bend over n pixels on either side has the
/// noise of one pixel divided by the square root of n³ / 6.
fn arm_px(z: f32, pixel_rad: f32, noise: &DepthNoise) -> usize {
    let noise_in_pixels = noise.sigma_m(z) / (z * pixel_rad);
    let cubed = 6.0 * (noise_in_pixels / SLOPE_SIGMA).powi(2);
    (cubed.cbrt() as usize).clamp(ARM_PX[0], ARM_PX[1])
}

#[cfg(test)]
impl Creases {
    /// Creases of given marks, for tests.
    pub(crate) fn from_marks(is_crease: Vec<bool>) -> Self {
        let bend = is_crease.iter().map(|&is| f32::from(is)).collect();
        Self {
            is_crease,
            bend,
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::{OrganizedCloud, Point, Rgba};
    use proptest::prelude::*;

    const WIDTH: usize = 640;

    /// Crease marks of an image band with depth `z(column, row)`.
    fn creases(z: impl Fn(f32, f32) -> f32) -> Vec<bool> {
        let points: Vec<Point> = (0..WIDTH * 40)
            .map(|i| {
                let z = z((i % WIDTH) as f32, (i / WIDTH) as f32);
                let x = ((i % WIDTH) as f32 - 320.0) / 585.0 * z;
                Point {
                    x,
                    y: (i / WIDTH) as f32 / 585.0 * z,
                    z,
                    color: Rgba::default(),
                }
            })
            .collect();
        let cloud = OrganizedCloud::new(&points, WIDTH, 40).unwrap();
        let cluster: Vec<u32> = (0..points.len() as u32).collect();
        let mut patch = Patch::default();
        patch.copy_cluster(&cloud, &cluster);
        let mut creases = Creases::default();
        creases.find(&patch, WIDTH, &DepthNoise::default());
        let is_crease = |pixel: &PatchPixel| creases.is_crease[pixel.index as usize];
        patch.pixels.iter().map(is_crease).collect()
    }

    /// Depth of two planes that meet at column 320, each inclined by `slope` metres per
    /// metre.
    fn folded(slope: f32, column: f32) -> f32 {
        1.0 / (1.0 + slope * (column - 320.0).abs() / 585.0)
    }

    #[test]
    fn a_concave_fold_is_a_crease_where_it_folds() {
        let marks = creases(|column, _| folded(1.0, column));
        for (i, marked) in marks.iter().enumerate() {
            let away = (i % WIDTH).abs_diff(320);
            assert!(
                if away <= 2 {
                    *marked
                } else {
                    away < 20 || !*marked
                },
                "{away}"
            );
        }
    }

    #[test]
    fn convex_and_shallow_folds_are_not_creases() {
        for slope in [-1.0, -0.5, 0.2] {
            assert!(
                !creases(|column, _| folded(slope, column)).contains(&true),
                "{slope}"
            );
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        #[test]
        fn a_plane_has_no_crease(a in -0.6..0.6_f32, b in -2.0..2.0_f32) {
            let plane = |column: f32, row: f32| 1.0 / (1.0 + (a * (column - 320.0) + b * row) / 585.0);
            prop_assert!(!creases(plane).contains(&true));
        }
    }
}
