//! Box profile: shape of an object relative to its bounding box, about the vertical axis.
//!
//! A lamp is a lamp whether it is tall or broad. The shape part of the descriptor is
//! metric, so it separates objects; this part is relative to the box, so it generalises
//! over the objects of a category.
//!
//! *Source*: the profile is a spin image (Johnson and Hebert 1999) about the axis of the
//! box instead of a surface point.

use super::local_surface::{LocalSurface, SurfaceGrid};
use super::soft_bins::{SoftBins, add, add_linear, add_weighted};
use crate::AxesKind;
use crate::projected_points::{LANES, ProjectedPoints};

/// Rows (height) and columns (distance from the axis) of the profile.
const PROFILE: (usize, usize) = (8, 6);
/// Rows (height) and columns (tilt) of the tilt histogram.
const TILT: (usize, usize) = (8, 6);
/// Rows (height) and columns (roughness) of the roughness histogram.
const ROUGHNESS: (usize, usize) = (6, 6);
/// Bins of the linearity histogram.
const N_LINEARITIES: usize = 8;

/// Largest roughness of the histogram; the largest possible is 0.58.
const ROUGHNESS_MAX: f32 = 0.4;

/// Weights of the four histograms. Chosen on views of mesh categories, objects apart, so
/// that known objects lose nothing.
const PROFILE_WEIGHT: f32 = 0.79;
const TILT_WEIGHT: f32 = 0.38;
const ROUGHNESS_WEIGHT: f32 = 0.47;
const LINEARITY_WEIGHT: f32 = 1.12;

/// Number of values of a box profile.
pub(super) const N_PROFILE_VALUES: usize =
    area(PROFILE) + area(TILT) + area(ROUGHNESS) + N_LINEARITIES;

/// Box profile with its scratch memory.
#[derive(Debug, Clone)]
pub(super) struct BoxProfile {
    grid: SurfaceGrid,
    profile: [f32; area(PROFILE)],
    tilts: [f32; area(TILT)],
    roughnesses: [f32; area(ROUGHNESS)],
    linearities: [f32; N_LINEARITIES],
}

const fn area((rows, columns): (usize, usize)) -> usize {
    rows * columns
}

impl BoxProfile {
    pub(super) fn new() -> Self {
        Self {
            grid: SurfaceGrid::default(),
            profile: [0.0; area(PROFILE)],
            tilts: [0.0; area(TILT)],
            roughnesses: [0.0; area(ROUGHNESS)],
            linearities: [0.0; N_LINEARITIES],
        }
    }

    /// Appends the values of points in the object frame, multiplied by `weight`: square
    /// roots of shares (Hellinger). `ranges_m` are the least and greatest coordinates of their
    /// bounding box.
    ///
    /// Without a known upward direction nothing is tilted: the values of the local
    /// surfaces are zero then.
    pub(super) fn append(
        &mut self,
        points: &ProjectedPoints,
        ranges_m: [(f32, f32); 3],
        (kind, weight): (AxesKind, f32),
        out: &mut Vec<f32>,
    ) {
        self.profile.fill(0.0);
        self.tilts.fill(0.0);
        self.roughnesses.fill(0.0);
        self.linearities.fill(0.0);
        self.add_profile(points, ranges_m);
        if kind == AxesKind::Upright {
            self.add_surfaces(points, ranges_m);
        }
        append_roots(&self.profile, weight * PROFILE_WEIGHT, out);
        append_roots(&self.tilts, weight * TILT_WEIGHT, out);
        append_roots(&self.roughnesses, weight * ROUGHNESS_WEIGHT, out);
        append_roots(&self.linearities, weight * LINEARITY_WEIGHT, out);
    }

    fn add_profile(&mut self, points: &ProjectedPoints, ranges_m: [(f32, f32); 3]) {
        let [x, y, z] = ranges_m;
        let (middle_x, middle_y) = (middle(x), middle(y));
        let half_diagonal_m = 0.5 * (x.1 - x.0).hypot(y.1 - y.0);
        let (per_radius, per_height) = (inverse(half_diagonal_m), inverse(z.1 - z.0));
        let (rows, columns) = (SoftBins::new(PROFILE.0), SoftBins::new(PROFILE.1));
        for block in points.blocks() {
            let mut radius = [0.0; LANES];
            for (i, radius) in radius.iter_mut().enumerate() {
                let (x, y) = (block.x[i] - middle_x, block.y[i] - middle_y);
                *radius = (x * x + y * y).sqrt() * per_radius;
            }
            let row = block
                .z
                .map(|height| rows.locate((height - z.0) * per_height));
            let column = radius.map(|radius| columns.locate(radius));
            for i in (0..LANES).filter(|&i| !block.x[i].is_nan()) {
                add(&mut self.profile, PROFILE.1, row[i], column[i]);
            }
        }
    }

    fn add_surfaces(&mut self, points: &ProjectedPoints, ranges_m: [(f32, f32); 3]) {
        let Self {
            grid,
            tilts,
            roughnesses,
            linearities,
            ..
        } = self;
        let per_height = inverse(ranges_m[2].1 - ranges_m[2].0);
        let locate = |n_bins: usize, value: f32| SoftBins::new(n_bins).locate(value);
        grid.for_each_surface(points, ranges_m, |surface| {
            let LocalSurface { n_points, .. } = surface;
            let height = 0.5 + surface.height_m * per_height;
            let row = locate(TILT.0, height);
            let column = locate(TILT.1, surface.tilt);
            add_weighted(tilts, TILT.1, (row, column), n_points);
            let row = locate(ROUGHNESS.0, height);
            let column = locate(ROUGHNESS.1, surface.roughness / ROUGHNESS_MAX);
            add_weighted(roughnesses, ROUGHNESS.1, (row, column), n_points);
            let bin = locate(N_LINEARITIES, surface.linearity);
            add_linear(linearities, bin, n_points);
        });
    }

    /// Index of each value after the vertical axis is reversed: heights are mirrored.
    pub(super) fn mirrored() -> impl Iterator<Item = usize> {
        let mirrored_rows = |first: usize, (rows, columns): (usize, usize)| {
            (0..rows * columns)
                .map(move |i| first + (rows - 1 - i / columns) * columns + i % columns)
        };
        let first_tilt = area(PROFILE);
        let first_roughness = first_tilt + area(TILT);
        let first_linearity = first_roughness + area(ROUGHNESS);
        mirrored_rows(0, PROFILE)
            .chain(mirrored_rows(first_tilt, TILT))
            .chain(mirrored_rows(first_roughness, ROUGHNESS))
            .chain(first_linearity..N_PROFILE_VALUES)
    }
}

fn append_roots(cells: &[f32], weight: f32, out: &mut Vec<f32>) {
    let scale = inverse(cells.iter().sum());
    out.extend(cells.iter().map(|cell| weight * (cell * scale).sqrt()));
}

fn middle((low, high): (f32, f32)) -> f32 {
    low + 0.5 * (high - low)
}

/// Inverse of a length or count; 0 for zero.
fn inverse(value: f32) -> f32 {
    if value > 0.0 { value.recip() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DescriptorFrame, ObjectPoints};
    use point_cloud::Point;

    /// Upper half of a cone of unit proportions, scaled along each axis.
    fn cone(scale_m: [f32; 3]) -> Vec<Point> {
        let point = |i: u16| {
            let (t, turn) = ((f32::from(i) + 0.5) / 4000.0, f32::from(i) * 2.399_963);
            let radius = 0.5 * (1.0 - t);
            Point {
                x: scale_m[0] * radius * turn.cos(),
                y: scale_m[1] * radius * turn.sin(),
                z: scale_m[2] * t,
                ..Point::default()
            }
        };
        (0..4000).map(point).collect()
    }

    fn profile(cloud: &[Point], kind: AxesKind) -> Vec<f32> {
        let frame = DescriptorFrame {
            object_from_source: [
                [1.0, 0.0, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0],
                [0.0, 0.0, 1.0, 0.0],
            ],
        };
        let mut points = ProjectedPoints::default();
        points.fill(ObjectPoints::all(cloud), &frame);
        let ranges = points.ranges_m().unwrap();
        let mut out = Vec::new();
        BoxProfile::new().append(&points, ranges, (kind, 1.0), &mut out);
        assert_eq!(out.len(), N_PROFILE_VALUES);
        out
    }

    fn distance(a: &[f32], b: &[f32]) -> f32 {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f32>().sqrt()
    }

    #[test]
    fn a_tall_and_a_small_cone_have_one_profile_and_a_turned_one_another() {
        let of = |scale_m| profile(&cone(scale_m), AxesKind::Principal);
        let cone = of([0.1, 0.1, 0.1]);
        for scale_m in [[0.05, 0.05, 0.05], [0.1, 0.1, 0.25]] {
            assert!(distance(&cone, &of(scale_m)) < 0.02, "{scale_m:?}");
        }
        assert!(distance(&cone, &of([0.1, 0.1, -0.1])) > 0.3);
    }

    #[test]
    fn reversing_the_vertical_axis_mirrors_the_profile() {
        let upright = profile(&cone([0.1, 0.08, 0.12]), AxesKind::Upright);
        let reversed = profile(&cone([0.1, -0.08, -0.12]), AxesKind::Upright);
        let mirrored: Vec<f32> = BoxProfile::mirrored().map(|i| upright[i]).collect();
        assert!(distance(&mirrored, &reversed) < 0.02);
    }

    #[test]
    fn surfaces_count_only_with_a_known_upward_direction() {
        let cloud = cone([0.1, 0.1, 0.1]);
        let first_surface = area(PROFILE);
        let is_zero = |values: &[f32]| values[first_surface..].iter().all(|value| *value == 0.0);
        assert!(is_zero(&profile(&cloud, AxesKind::Principal)));
        assert!(!is_zero(&profile(&cloud, AxesKind::Upright)));
    }
}
