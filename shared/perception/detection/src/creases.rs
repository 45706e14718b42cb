//! Concave creases: lines along which one object stands on or against another.

use crate::patch::{Patch, PatchPixel};
use sensor_noise::depth_sigma_m;
use std::ops::Range;

/// The width of the image in radians, roughly; the cloud does not say it, and
/// the measure of a crease depends on it only in proportion.
const IMAGE_WIDTH_RAD: f32 = 1.09;

/// The sides of a crease are taken so long that the noise of depth changes
/// their slope by this much (standard deviation).
const SLOPE_SIGMA: f32 = 0.14;

/// Fewest and most pixels of a side.
const ARM_PX: [usize; 2] = [4, 24];

/// A surface is concave where its depth rises towards the middle by more than
/// this, metres a metre across the line of sight on either side.
const SLOPE_MIN: f32 = 0.4;

/// Neighbours in a row or column belong to one surface up to this step of
/// depth, metres, at 1 m; it grows with squared depth.
const STEP_M: f32 = 0.012;

/// A crease is widened by this many pixels on either side, so that its ends
/// leave no gap.
const DILATION_PX: usize = 2;

/// A cluster with fewer pixels of creases has none that parts it: the handle of a
/// cup meets it in creases, too.
const CREASE_PIXELS_MIN: usize = 150;

/// Buffers, and the creases found last.
#[derive(Debug, Default)]
pub(crate) struct Creases {
    /// Per index of the patch: whether a crease runs through it.
    pub(crate) is_crease: Vec<bool>,
    /// Per index: the stronger bend of its row's and its column's surface, metres a
    /// metre, concave positive; NaN where none could be measured.
    pub(crate) bend: Vec<f32>,
    by_column: Vec<PatchPixel>,
    next_in_column: Vec<u32>,
    fit: BendFit,
}

impl Creases {
    /// Marks the creases of a cluster, seen along rows and along columns; its image
    /// was so many pixels wide. Returns whether it has some that may part it.
    pub(crate) fn find(&mut self, patch: &Patch, image_width: usize) -> bool {
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
                let bends = fit.bends(surface, pixel_rad);
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

    /// Sorts the pixels, which are row by row, column by column.
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

/// Notes the bends of a surface, and the creases where they are concave enough.
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

/// Fits, around each pixel of a surface, a straight line plus a symmetric bend to
/// the inverse depth, which is linear in the image on a plane.
#[derive(Debug, Default)]
struct BendFit {
    /// Prefix sums of the inverse depth and of its product with the index, which make
    /// the work independent of the length of the arms. Double precision: the second
    /// sum of a long row dwarfs what a bend changes.
    sums: [Vec<f64>; 2],
    bends: Vec<f32>,
}

impl BendFit {
    /// The bend at each pixel, metres a metre; NaN where the arms would be too short.
    fn bends(&mut self, surface: &[PatchPixel], pixel_rad: f32) -> &[f32] {
        self.accumulate(surface);
        let n = surface.len();
        self.bends.clear();
        self.bends.resize(n, f32::NAN);
        let most = (n - 1) / 2;
        let arm = arm_px(surface[0].z, pixel_rad).min(most);
        for short in ARM_PX[0]..arm {
            self.fit_bends(short..short + 1, short);
            self.fit_bends(n - 1 - short..n - short, short);
        }
        self.fit_bends(arm..n - arm, arm);
        for (bend, pixel) in self.bends.iter_mut().zip(surface) {
            *bend = *bend * pixel.z / pixel_rad;
        }
        &self.bends
    }

    fn accumulate(&mut self, surface: &[PatchPixel]) {
        let [plain, weighted] = &mut self.sums;
        let mut sum = [0.0; 2];
        for sums in [&mut *plain, &mut *weighted] {
            sums.clear();
            sums.push(0.0);
        }
        plain.extend(surface.iter().map(|pixel| {
            sum[0] += f64::from(1.0 / pixel.z);
            sum[0]
        }));
        weighted.extend(surface.iter().enumerate().map(|(i, pixel)| {
            sum[1] += i as f64 * f64::from(1.0 / pixel.z);
            sum[1]
        }));
    }

    /// Slope of inverse depth, per pixel, away from each of some pixels on both
    /// sides, over arms of a length. Without a branch, so that the compiler makes
    /// vector instructions of it.
    fn fit_bends(&mut self, pixels: Range<usize>, arm: usize) {
        let (first, n) = (pixels.start, pixels.len());
        let [plain, weighted] = &self.sums;
        let ends = [first - arm, first, first + 1, first + arm + 1];
        let p = ends.map(|end| &plain[end..end + n]);
        let w = ends.map(|end| &weighted[end..end + n]);
        let mean = 0.5 * (arm as f64 + 1.0);
        // Sum of (|j| - mean)² over both arms.
        let spread = arm as f64 * ((arm * arm) as f64 - 1.0) / 6.0;
        let bends = &mut self.bends[pixels];
        for i in 0..n {
            let at = (first + i) as f64;
            let (left, right) = (p[1][i] - p[0][i], p[3][i] - p[2][i]);
            // Sum of |j| w and of w over both arms, without the pixel itself.
            let weighted = (w[3][i] - w[2][i]) - at * right + at * left - (w[1][i] - w[0][i]);
            bends[i] = ((weighted - mean * (right + left)) / spread) as f32;
        }
    }
}

/// Pixels of a side of a crease at a depth. The bend of n pixels to either
/// side has the noise of one pixel divided by the root of n³ / 6.
fn arm_px(z: f32, pixel_rad: f32) -> usize {
    let noise_in_pixels = depth_sigma_m(z) / (z * pixel_rad);
    let cubed = 6.0 * (noise_in_pixels / SLOPE_SIGMA).powi(2);
    (cubed.cbrt() as usize).clamp(ARM_PX[0], ARM_PX[1])
}

#[cfg(test)]
impl Creases {
    /// Creases as given, for tests of what follows from them.
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

    /// A band of the image at `z(column, row)`, and its cluster.
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
        creases.find(&patch, WIDTH);
        let is_crease = |pixel: &PatchPixel| creases.is_crease[pixel.index as usize];
        patch.pixels.iter().map(is_crease).collect()
    }

    /// Depth of two planes that meet at column 320, each leaving the line of
    /// sight's normal by `slope` metres a metre.
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
    fn convex_folds_and_shallow_ones_are_none() {
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
