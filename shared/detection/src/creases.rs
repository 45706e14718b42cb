//! Concave creases: lines along which one object stands on or against another.

use crate::clusters::Clusters;
use crate::prism::OUTSIDE;
use point_cloud::OrganizedCloud;

/// The width of the image in radians, roughly; the cloud does not say it, and
/// the measure of a crease depends on it only in proportion.
const IMAGE_WIDTH_RAD: f32 = 1.09;

/// Length of each side of a crease that is looked at, metres.
const ARM_M: f32 = 0.012;

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

/// Buffers, and the creases found last.
#[derive(Debug, Default)]
pub(crate) struct Creases {
    /// Per pixel: whether a crease runs through it.
    pub(crate) is_crease: Vec<bool>,
    line: Vec<LinePixel>,
    sums: Vec<[f32; 2]>,
}

/// A pixel of a row or column; depth zero where it is in no cluster.
#[derive(Debug, Clone, Copy)]
struct LinePixel {
    index: u32,
    cluster: u32,
    z: f32,
}

impl Creases {
    /// Marks the creases of all clusters, seen along rows and along columns.
    /// Returns the number of marked pixels.
    pub(crate) fn find(&mut self, cloud: &OrganizedCloud<'_>, clusters: &Clusters) -> usize {
        let (width, height) = (cloud.width(), cloud.height());
        self.is_crease.clear();
        self.is_crease.resize(width * height, false);
        let pixel_rad = IMAGE_WIDTH_RAD / width as f32;
        for row in 0..height {
            self.take_line(cloud, clusters, (0..width).map(|column| row * width + column));
            self.find_in_line(pixel_rad);
        }
        for column in 0..width {
            self.take_line(cloud, clusters, (0..height).map(|row| row * width + column));
            self.find_in_line(pixel_rad);
        }
        self.is_crease.iter().filter(|&&is_crease| is_crease).count()
    }

    fn take_line(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        clusters: &Clusters,
        indices: impl Iterator<Item = usize>,
    ) {
        self.line.clear();
        self.line.extend(indices.filter(|&i| clusters.cluster_of[i] != OUTSIDE).map(|index| {
            LinePixel {
                index: index as u32,
                cluster: clusters.cluster_of[index],
                z: cloud.points()[index].z,
            }
        }));
    }

    /// Looks for creases in each part of the line that is one surface.
    fn find_in_line(&mut self, pixel_rad: f32) {
        let Self { is_crease, line, sums } = self;
        let one_surface = |a: &LinePixel, b: &LinePixel| {
            a.cluster == b.cluster && (a.z - b.z).abs() <= STEP_M * a.z * a.z
        };
        for surface in line.chunk_by(one_surface) {
            if surface.len() > 2 * ARM_PX[0] {
                find_in_surface(surface, pixel_rad, sums, is_crease);
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
    sums: &mut Vec<[f32; 2]>,
    is_crease: &mut [bool],
) {
    // Sums are taken from the first value, which keeps single precision exact enough.
    let first = 1.0 / surface[0].z;
    let mut sum = [0.0; 2];
    sums.clear();
    sums.push(sum);
    for (i, pixel) in surface.iter().enumerate() {
        let value = 1.0 / pixel.z - first;
        sum = [sum[0] + value, sum[1] + i as f32 * value];
        sums.push(sum);
    }
    for (i, pixel) in surface.iter().enumerate() {
        let reach = i.min(surface.len() - 1 - i);
        let arm = ((ARM_M / (pixel.z * pixel_rad)) as usize).clamp(ARM_PX[0], ARM_PX[1]).min(reach);
        if arm >= ARM_PX[0] {
            let bend = bend_of(sums, i, arm);
            if bend * pixel.z / pixel_rad >= SLOPE_MIN {
                let wide = i.saturating_sub(SPREAD_PX)..surface.len().min(i + SPREAD_PX + 1);
                surface[wide].iter().for_each(|near| is_crease[near.index as usize] = true);
            }
        }
    }
}

/// Slope of inverse depth, per pixel, away from pixel `i` on both sides.
#[inline]
fn bend_of(sums: &[[f32; 2]], i: usize, arm: usize) -> f32 {
    let between = |from: usize, to: usize, k: usize| sums[to][k] - sums[from][k];
    let (n, at) = (arm as f32, i as f32);
    let (left, right) = ((i - arm, i), (i + 1, i + arm + 1));
    // Sum of |j| w and of w over both arms, without the pixel itself.
    let weighted = between(right.0, right.1, 1) - at * between(right.0, right.1, 0)
        + at * between(left.0, left.1, 0)
        - between(left.0, left.1, 1);
    let plain = between(right.0, right.1, 0) + between(left.0, left.1, 0);
    let mean = 0.5 * (n + 1.0);
    // Sum of (|j| - mean)² over both arms.
    let spread = n * (n * n - 1.0) / 6.0;
    (weighted - mean * plain) / spread
}
