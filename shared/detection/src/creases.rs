//! Concave creases: lines along which one object stands on or against another.

use crate::clusters::Clusters;
use crate::sensor_noise::depth_sigma_m;
use point_cloud::OrganizedCloud;

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
const SPREAD_PX: usize = 2;

/// A cluster with fewer pixels of creases has none that parts it: the handle of a
/// cup meets it in creases, too.
const CREASE_PIXELS_MIN: usize = 150;

/// Buffers, and the creases found last.
#[derive(Debug, Default)]
pub(crate) struct Creases {
    /// Per pixel: whether a crease runs through it.
    pub(crate) is_crease: Vec<bool>,
    /// Per pixel: the stronger bend of its row's and its column's surface, metres
    /// a metre, concave positive; NaN where none could be measured.
    pub(crate) bend: Vec<f32>,
    /// Per cluster: whether it has creases that may part it.
    pub(crate) may_part: Vec<bool>,
    line: Vec<LinePixel>,
    turned: Vec<LinePixel>,
    next_in_column: Vec<u32>,
    sums: Vec<[f64; 2]>,
}

/// What is written, pixel by pixel.
struct Marks<'a> {
    is_crease: &'a mut [bool],
    bend: &'a mut [f32],
}

/// A pixel of a cluster, while the image is read line by line.
#[derive(Debug, Clone, Copy, Default)]
struct LinePixel {
    index: u32,
    z: f32,
}

impl Creases {
    /// Marks the creases of the clusters that may be piles, seen along rows and
    /// along columns. Returns whether any cluster has some that may part it.
    pub(crate) fn find(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        clusters: &Clusters,
        may_be_pile: &[bool],
    ) -> bool {
        let width = cloud.width();
        self.is_crease.clear();
        self.is_crease.resize(cloud.points().len(), false);
        self.bend.clear();
        self.bend.resize(cloud.points().len(), f32::NAN);
        self.may_part.clear();
        for (cluster, &may_be_pile) in may_be_pile.iter().enumerate() {
            if !may_be_pile {
                self.may_part.push(false);
                continue;
            }
            let pixels = clusters.pixels(cluster);
            self.line.clear();
            self.line.extend(pixels.iter().map(|&index| LinePixel {
                index,
                z: cloud.points()[index as usize].z,
            }));
            self.find_in_lines(width, |pixel| pixel as usize / width);
            self.turn(width);
            self.find_in_lines(width, |pixel| pixel as usize % width);
            let creases = pixels
                .iter()
                .filter(|&&pixel| self.is_crease[pixel as usize]);
            self.may_part.push(creases.count() >= CREASE_PIXELS_MIN);
        }
        self.may_part.contains(&true)
    }

    /// Sorts the line's pixels, which are row by row, column by column.
    fn turn(&mut self, width: usize) {
        let Self {
            line,
            turned,
            next_in_column,
            ..
        } = self;
        let column = |pixel: &LinePixel| pixel.index as usize % width;
        next_in_column.clear();
        next_in_column.resize(width + 1, 0);
        for pixel in line.iter() {
            next_in_column[column(pixel) + 1] += 1;
        }
        for column in 0..width {
            next_in_column[column + 1] += next_in_column[column];
        }
        turned.clear();
        turned.resize(line.len(), LinePixel::default());
        for pixel in line.iter() {
            let place = &mut next_in_column[column(pixel)];
            turned[*place as usize] = *pixel;
            *place += 1;
        }
        std::mem::swap(line, turned);
    }

    /// Looks for creases in each part of a row or column that is one surface.
    fn find_in_lines(&mut self, width: usize, line_of: impl Fn(u32) -> usize) {
        let Self {
            is_crease,
            bend,
            line,
            sums,
            ..
        } = self;
        let mut marks = Marks { is_crease, bend };
        let one_surface = |a: &LinePixel, b: &LinePixel| {
            line_of(a.index) == line_of(b.index) && (a.z - b.z).abs() <= STEP_M * a.z * a.z
        };
        let pixel_rad = IMAGE_WIDTH_RAD / width as f32;
        for surface in line.chunk_by(one_surface) {
            if surface.len() > 2 * ARM_PX[0] {
                find_in_surface(surface, pixel_rad, sums, &mut marks);
            }
        }
    }
}

/// Fits, around each pixel, a straight line plus a symmetric bend to the
/// inverse depth, which is linear in the image on a plane. Prefix sums make
/// the work independent of the length of the arms.
fn find_in_surface(
    surface: &[LinePixel],
    pixel_rad: f32,
    sums: &mut Vec<[f64; 2]>,
    marks: &mut Marks<'_>,
) {
    let mut sum = [0.0; 2];
    sums.clear();
    sums.push(sum);
    for (i, pixel) in surface.iter().enumerate() {
        // Double precision: the second sum of a long row dwarfs what a bend changes.
        let value = f64::from(1.0 / pixel.z);
        sum = [sum[0] + value, sum[1] + i as f64 * value];
        sums.push(sum);
    }
    let arm_wanted = arm_px(surface[0].z, pixel_rad);
    for (i, pixel) in surface.iter().enumerate() {
        let reach = i.min(surface.len() - 1 - i);
        let arm = arm_wanted.min(reach);
        if arm >= ARM_PX[0] {
            let bend = bend_of(sums, i, arm) * pixel.z / pixel_rad;
            let stronger = &mut marks.bend[pixel.index as usize];
            *stronger = stronger.max(bend);
            if bend >= SLOPE_MIN {
                let wide = i.saturating_sub(SPREAD_PX)..surface.len().min(i + SPREAD_PX + 1);
                for near in &surface[wide] {
                    marks.is_crease[near.index as usize] = true;
                }
            }
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

/// Slope of inverse depth, per pixel, away from pixel `i` on both sides.
#[inline]
fn bend_of(sums: &[[f64; 2]], i: usize, arm: usize) -> f32 {
    let between = |from: usize, to: usize, k: usize| sums[to][k] - sums[from][k];
    let (n, at) = (arm as f64, i as f64);
    let (left, right) = ((i - arm, i), (i + 1, i + arm + 1));
    // Sum of |j| w and of w over both arms, without the pixel itself.
    let weighted = between(right.0, right.1, 1) - at * between(right.0, right.1, 0)
        + at * between(left.0, left.1, 0)
        - between(left.0, left.1, 1);
    let plain = between(right.0, right.1, 0) + between(left.0, left.1, 0);
    let mean = 0.5 * (n + 1.0);
    // Sum of (|j| - mean)² over both arms.
    let spread = n * (n * n - 1.0) / 6.0;
    ((weighted - mean * plain) / spread) as f32
}

#[cfg(test)]
impl Creases {
    /// Creases as given, for tests of what follows from them.
    pub(crate) fn from_marks(is_crease: Vec<bool>, may_part: Vec<bool>) -> Self {
        let bend = is_crease.iter().map(|&is| f32::from(is)).collect();
        Self {
            is_crease,
            bend,
            may_part,
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::{Point, Rgba};
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
        let pixels: Vec<u32> = (0..points.len() as u32).collect();
        let mut clusters = Clusters::default();
        clusters.join(&cloud, &pixels, 1);
        let mut creases = Creases::default();
        creases.find(&cloud, &clusters, &vec![true; clusters.len()]);
        creases.is_crease
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
