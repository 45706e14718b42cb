//! RANSAC plane search on voxel centroids.

use super::voxel_centroids::VoxelCentroids;
use crate::affine_form::AffineForm;
use geometry::Plane;
use nalgebra::{Unit, Vector3};
use random::Random;

/// Target number of centroids on which a hypothesis is scored.
const N_COUNTED_AIMED: usize = 2400;

/// Greatest number of hypotheses for one plane.
const N_HYPOTHESES_MAX: usize = 800;

/// Accepted probability of drawing no good hypothesis. Chosen.
const MISS_CHANCE: f64 = 0.005;

/// Assumed probability that three centroids of one cube are on one plane and far enough
/// apart, given that the first is on it. Chosen.
const NEIGHBOURS_AGREE: f64 = 0.2;

/// Cone of accepted plane normals around up.
#[derive(Debug, Clone, Copy)]
pub(super) struct UpCone {
    pub(super) up: Unit<Vector3<f64>>,
    /// Least cosine between the normal and up.
    pub(super) cos_min: f64,
}

impl UpCone {
    /// Plane oriented upwards; `None` when its normal is outside of the cone.
    pub(super) fn admit(&self, plane: Plane) -> Option<Plane> {
        let cos = plane.normal.dot(&self.up);
        let upwards = if cos < 0.0 {
            Plane {
                normal: -plane.normal,
                offset_m: -plane.offset_m,
            }
        } else {
            plane
        };
        (cos.abs() >= self.cos_min).then_some(upwards)
    }
}

/// Largest plane: the plane with the most unassigned centroids in its band, refined by
/// least squares; `None` when no hypothesis has `n_min`. RANSAC (Fischler and Bolles 1981)
/// with local draws and an adaptive number of rounds.
pub(super) fn largest_plane(
    centroids: &VoxelCentroids,
    cone: &UpCone,
    band_m: f32,
    n_min: usize,
    random: &mut Random,
    counted: &mut VoxelCentroids,
) -> Option<Plane> {
    if centroids.n_unassigned() < n_min.max(3) {
        return None;
    }
    centroids.subsample_into(N_COUNTED_AIMED, counted);
    let mut best: Option<(Plane, u32)> = None;
    let (mut round, mut n_rounds) = (0, N_HYPOTHESES_MAX);
    while round < n_rounds {
        round += 1;
        let drawn = centroids.draw(random);
        let Some(plane) = drawn.and_then(|drawn| through(centroids, drawn, cone)) else {
            continue;
        };
        let n = counted.count_in_band(&AffineForm::from(&plane), band_m);
        if best.as_ref().is_none_or(|&(_, n_best)| n > n_best) {
            let better = fitted(counted, &plane, cone, band_m)
                .map(|plane| {
                    (
                        plane,
                        counted.count_in_band(&AffineForm::from(&plane), band_m),
                    )
                })
                .filter(|&(_, n_fitted)| n_fitted > n)
                .unwrap_or((plane, n));
            n_rounds = rounds_needed(better.1, counted.len());
            best = Some(better);
        }
    }
    let mut plane = best?.0;
    for _ in 0..3 {
        plane = fitted(centroids, &plane, cone, band_m).unwrap_or(plane);
    }
    let enough = centroids
        .unassigned_in_band(&AffineForm::from(&plane), band_m)
        .nth(n_min.saturating_sub(1))
        .is_some();
    enough.then_some(plane)
}

fn through(centroids: &VoxelCentroids, drawn: [usize; 3], cone: &UpCone) -> Option<Plane> {
    let [a, b, c] = drawn.map(|i| centroids.position(i));
    cone.admit(Plane::through_points(&a, &b, &c)?)
}

/// Least-squares plane of the unassigned centroids in a plane's band.
fn fitted(centroids: &VoxelCentroids, plane: &Plane, cone: &UpCone, band_m: f32) -> Option<Plane> {
    let axes = centroids
        .band_moments(&AffineForm::from(plane), band_m)
        .principal_axes()?;
    let normal = Unit::try_new(axes.axes.column(2).into_owned(), 0.5)?;
    cone.admit(Plane::through(&axes.centroid, normal))
}

fn rounds_needed(n_inliers: u32, n: usize) -> usize {
    let hit = (NEIGHBOURS_AGREE * f64::from(n_inliers) / n as f64).clamp(1e-6, 0.99);
    let rounds = (MISS_CHANCE.ln() / (1.0 - hit).ln()).ceil();
    rounds.min(N_HYPOTHESES_MAX as f64) as usize
}
