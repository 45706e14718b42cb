//! RANSAC plane search on the subsampled image.

use crate::affine_form::AffineForm;
use crate::samples::Samples;
use geometry::Plane;
use nalgebra::{Point3, Unit, Vector3};
use random::Random;

/// Target number of samples on which a hypothesis is scored.
const N_COUNTED_AIMED: usize = 2400;

/// Half side of the window, in samples, from which the second and third point of a
/// hypothesis are drawn; neighbours share a surface more often than random points. Chosen.
const WINDOW: usize = 32;

/// Least distance of drawn neighbours, in samples; nearer ones give a plane dominated by
/// noise. Chosen.
const WINDOW_MIN: isize = 5;

/// Greatest number of hypotheses for one plane.
const N_HYPOTHESES_MAX: usize = 240;

/// Accepted probability of drawing no good hypothesis. Chosen.
const MISS_CHANCE: f64 = 0.005;

/// Assumed probability that two window neighbours of an inlier are inliers too. Chosen.
const NEIGHBOURS_AGREE: f64 = 0.3;

/// Buffers of the plane search.
#[derive(Debug, Default)]
pub(crate) struct PlaneSearchBuffers {
    free: Vec<u32>,
    counted: Samples,
}

/// Constraint on the direction of a plane's normal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NormalConstraint {
    /// Up direction, camera frame.
    pub(crate) up: Unit<Vector3<f64>>,
    /// Least cosine between the normal, or its opposite, and up.
    pub(crate) cos_min: f64,
}

impl NormalConstraint {
    fn allows(&self, plane: &Plane) -> bool {
        plane.normal.dot(&self.up).abs() >= self.cos_min
    }
}

/// Largest plane: the plane with the most unassigned samples in its band, refined by least
/// squares; `None` when no hypothesis has `n_min` inliers. The positive side of the plane
/// holds the camera.
///
/// RANSAC (Fischler and Bolles 1981) with neighbouring points, local optimisation of each
/// new best hypothesis (Chum, Matas and Kittler 2003) and an adaptive number of rounds.
pub(crate) fn largest_plane(
    samples: &Samples,
    limit: Option<&NormalConstraint>,
    n_min: usize,
    random: &mut Random,
    buffers: &mut PlaneSearchBuffers,
) -> Option<Plane> {
    let allowed = |plane: &Plane| limit.is_none_or(|limit| limit.allows(plane));
    buffers.free.clear();
    buffers
        .free
        .extend((0..samples.len() as u32).filter(|&i| samples.is_unassigned(i as usize)));
    if buffers.free.len() < n_min.max(3) {
        return None;
    }
    let step = (buffers.free.len() / N_COUNTED_AIMED).max(1);
    samples.subsample_into(step, &mut buffers.counted);
    let counted = &buffers.counted;

    let mut best: Option<(Plane, u32)> = None;
    let mut n_rounds = N_HYPOTHESES_MAX;
    let mut round = 0;
    while round < n_rounds {
        round += 1;
        let Some(plane) = hypothesis(samples, &buffers.free, random).filter(&allowed) else {
            continue;
        };
        let n_inliers = counted.count_inliers(&AffineForm::from(&plane));
        if best.as_ref().is_none_or(|&(_, n_best)| n_inliers > n_best) {
            let better = locally_optimised(counted, plane, n_inliers, &allowed);
            n_rounds = rounds_needed(better.1, counted.len());
            best = Some(better);
        }
    }
    let plane = refined(samples, best?.0, &allowed);
    let n_inliers = samples.count_inliers(&AffineForm::from(&plane)) as usize;
    (n_inliers >= n_min).then(|| plane.facing(&Point3::origin()))
}

/// Plane hypothesis through a random sample and two of its neighbours.
fn hypothesis(samples: &Samples, free: &[u32], random: &mut Random) -> Option<Plane> {
    let anchor = free[random.below(free.len())] as usize;
    let second = neighbour(samples, anchor, random)?;
    let third = neighbour(samples, anchor, random)?;
    Plane::through_points(
        &samples.position(anchor),
        &samples.position(second),
        &samples.position(third),
    )
}

fn neighbour(samples: &Samples, anchor: usize, random: &mut Random) -> Option<usize> {
    let mut around_zero = || random.below(2 * WINDOW + 1) as isize - WINDOW as isize;
    let (columns, rows) = (around_zero(), around_zero());
    if columns.abs().max(rows.abs()) < WINDOW_MIN {
        return None;
    }
    let column = (anchor % samples.width()).checked_add_signed(columns)?;
    let row = (anchor / samples.width()).checked_add_signed(rows)?;
    let inside = column < samples.width() && row < samples.height();
    let index = row * samples.width() + column;
    (inside && samples.is_unassigned(index)).then_some(index)
}

/// Local optimisation: least squares over the inliers of a hypothesis while their number
/// grows.
fn locally_optimised(
    counted: &Samples,
    mut plane: Plane,
    mut n_inliers: u32,
    allowed: &impl Fn(&Plane) -> bool,
) -> (Plane, u32) {
    for _ in 0..3 {
        let Some(fitted) = fitted(counted, &plane).filter(allowed) else {
            break;
        };
        let n_fitted = counted.count_inliers(&AffineForm::from(&fitted));
        if n_fitted <= n_inliers {
            break;
        }
        (plane, n_inliers) = (fitted, n_fitted);
    }
    (plane, n_inliers)
}

/// Least-squares refinement over all samples, repeated because the inliers change with the
/// plane.
fn refined(samples: &Samples, mut plane: Plane, allowed: &impl Fn(&Plane) -> bool) -> Plane {
    for _ in 0..2 {
        match fitted(samples, &plane).filter(allowed) {
            Some(better) => plane = better,
            None => break,
        }
    }
    plane
}

/// Least-squares plane of the inliers of another plane.
fn fitted(samples: &Samples, plane: &Plane) -> Option<Plane> {
    let axes = samples
        .inlier_moments(&AffineForm::from(plane))
        .principal_axes()?;
    let normal = Unit::try_new(axes.axes.column(2).into_owned(), 0.5)?;
    Some(Plane::through(&axes.centroid, normal))
}

/// Adaptive number of RANSAC rounds for the inlier share found so far.
fn rounds_needed(n_inliers: u32, n: usize) -> usize {
    let hit = (NEIGHBOURS_AGREE * f64::from(n_inliers) / n as f64).clamp(1e-6, 0.99);
    (MISS_CHANCE.ln() / (1.0 - hit).ln())
        .ceil()
        .min(N_HYPOTHESES_MAX as f64) as usize
}
