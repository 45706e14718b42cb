//! Features of a pair of adjacent regions.

use super::boundary::RegionBoundary;
use super::region::Region;
use sensor_noise::DepthNoise;

/// Number of features of a pair.
pub const N_FEATURES: usize = 35;

/// Features of a pair of adjacent regions, in the order of [`FEATURE_NAMES`].
pub type PairFeatures = [f32; N_FEATURES];

/// Names of the features.
pub const FEATURE_NAMES: [&str; N_FEATURES] = [
    "log of the smaller area, thousand pixels at 1 m",
    "log of the larger area, thousand pixels at 1 m",
    "log of the boundary over the root of the smaller area",
    "share of the boundary with unknown continuation",
    "concave share of the boundary",
    "convex share of the boundary",
    "mean bend of the boundary, metres per metre",
    "mean depth step across the boundary, metres at 1 m",
    "colour difference of the regions, CIE 1976",
    "colour difference across the boundary, 0 to 255",
    "colour deviation within the smaller region",
    "colour deviation within the larger region",
    "cosine between the normals",
    "distance of the smaller region's centroid from the larger one's plane, metres",
    "distance of the larger region's centroid from the smaller one's plane, metres",
    "deviation of the smaller region from a plane, sigmas",
    "deviation of the larger region from a plane, sigmas",
    "deviation of both from one plane, sigmas",
    "gap in height between the upper and the lower region, metres",
    "least height of the smaller region over the table, metres",
    "least height of the larger region over the table, metres",
    "log of the common box's volume over the sum of both",
    "log of the common footprint over the larger one",
    "longest side of the common box, metres",
    "upward component of the smaller region's normal",
    "upward component of the larger region's normal",
    "convexity of the centroids, metres per metre",
    "height of the boundary over the lower region's top, metres",
    "height of the boundary over the upper region's bottom, metres",
    "deviation of the boundary's height, metres",
    "longest side of the cluster's box, metres",
    "log of the share of both in the area of the cluster",
    "mean log odds that the edges along the boundary are boundaries of objects",
    "share of the boundary across a gap without depth",
    "1 for regions of one cluster, 0 for those of two",
];

/// Place of the footprint of the common box among the features.
pub(super) const LOG_FOOTPRINT_RATIO: usize = 22;

/// Greatest deviation from a plane, sigmas.
const DEVIATION_MAX: f32 = 30.0;

/// Greatest distance, metres.
const DISTANCE_MAX_M: f32 = 0.3;

/// Surroundings of a pair of regions.
pub(super) struct PairContext<'a> {
    /// Both regions together.
    pub(super) both: &'a Region,
    /// Cluster of the regions, or their two clusters together.
    pub(super) cluster: &'a Region,
    pub(super) is_one_cluster: bool,
    /// Noise of the depth image.
    pub(super) noise: &'a DepthNoise,
}

/// Features of two regions with their boundary.
pub(super) fn pair_features(
    boundary: &RegionBoundary,
    [a, b]: [&Region; 2],
    context: &PairContext<'_>,
) -> PairFeatures {
    let PairContext {
        both,
        cluster,
        is_one_cluster,
        noise,
    } = *context;
    let (small, large) = if a.n_pixels_at_1m <= b.n_pixels_at_1m {
        (a, b)
    } else {
        (b, a)
    };
    let n_pairs = boundary.n_pairs.max(1) as f32;
    let n_known = (boundary.n_pairs - boundary.n_unknown).max(1) as f32;
    let share = |n: u32| n as f32 / n_pairs;
    let length = n_pairs * both.depth_m / small.n_pixels_at_1m.sqrt();
    let deviation =
        |region: &Region| (region.plane_rms_m / noise.sigma_m(region.depth_m)).min(DEVIATION_MAX);
    let [lower, upper] = by_height(small, large);
    let boundary_m = boundary.height_m / n_pairs;
    let variance_m2 = boundary.height_squares_m2 / n_pairs - boundary_m * boundary_m;
    [
        (small.n_pixels_at_1m / 1000.0).ln(),
        (large.n_pixels_at_1m / 1000.0).ln(),
        length.ln(),
        share(boundary.n_unknown),
        share(boundary.n_concave),
        share(boundary.n_convex),
        boundary.bend / n_known,
        boundary.step_m / n_pairs,
        small.color.delta_e(&large.color),
        boundary.color_step / n_pairs,
        small.color_sigma,
        large.color_sigma,
        small.normal.dot(&large.normal).abs(),
        plane_distance_m(small, large),
        plane_distance_m(large, small),
        deviation(small),
        deviation(large),
        deviation(both),
        (upper.height_m[0] - lower.height_m[1]).clamp(-DISTANCE_MAX_M, DISTANCE_MAX_M),
        small.height_m[0].min(DISTANCE_MAX_M),
        large.height_m[0].min(DISTANCE_MAX_M),
        (volume_m3(both) / (volume_m3(small) + volume_m3(large))).ln(),
        (footprint_m2(both) / footprint_m2(small).max(footprint_m2(large))).ln(),
        longest_side_m(both),
        small.normal.z.abs(),
        large.normal.z.abs(),
        convexity(small, large),
        (boundary_m - lower.height_m[1]).clamp(-DISTANCE_MAX_M, DISTANCE_MAX_M),
        (boundary_m - upper.height_m[0]).clamp(-DISTANCE_MAX_M, DISTANCE_MAX_M),
        variance_m2.max(0.0).sqrt(),
        longest_side_m(cluster),
        (both.n_pixels_at_1m / cluster.n_pixels_at_1m).ln(),
        boundary.mean_log_odds(),
        share(boundary.n_gaps),
        f32::from(u8::from(is_one_cluster)),
    ]
}

/// Distance of a region's centroid from the plane of another one, metres, up to
/// [`DISTANCE_MAX_M`].
fn plane_distance_m(from: &Region, plane: &Region) -> f32 {
    let distance_m = (from.centroid - plane.centroid).dot(&plane.normal).abs();
    distance_m.min(DISTANCE_MAX_M)
}

/// Area of a region's footprint, square metres.
fn footprint_m2(region: &Region) -> f32 {
    region.sides_m[0] * region.sides_m[1]
}

/// Volume of a region's box, cubic metres.
fn volume_m3(region: &Region) -> f32 {
    footprint_m2(region) * region.sides_m[2]
}

/// Longest side of a region's box, metres.
fn longest_side_m(region: &Region) -> f32 {
    region.sides_m.into_iter().fold(0.0, f32::max)
}

/// Convexity of two surfaces (Stein et al. 2014): positive when they bend away from each
/// other, negative when they face each other.
fn convexity(a: &Region, b: &Region) -> f32 {
    let between = a.centroid - b.centroid;
    (a.normal - b.normal).dot(&between) / between.norm().max(1e-6)
}

/// Lower and upper region by the middle of their heights.
fn by_height<'a>(a: &'a Region, b: &'a Region) -> [&'a Region; 2] {
    let middle = |region: &Region| region.height_m[0] + region.height_m[1];
    if middle(a) <= middle(b) {
        [a, b]
    } else {
        [b, a]
    }
}
