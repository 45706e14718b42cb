//! RANSAC plane search on samples.

use crate::affine_form::AffineForm;
use crate::samples::Samples;
use geometry::Plane;
use nalgebra::{Point3, Unit, Vector3};
use point_cloud::PrincipalAxes;
use random::Random;

/// Target number of samples on which a hypothesis is scored.
const N_COUNTED_AIMED: usize = 2400;

/// Half side of the window, in samples, from which the second and third point of a
/// hypothesis are drawn; neighbours share a surface more often than random points. Chosen.
const WINDOW: usize = 32;

/// Least distance of drawn neighbours, in samples; nearer ones give a plane dominated by
/// noise. Chosen.
const WINDOW_MIN: isize = 5;

/// Accepted probability of drawing no good hypothesis. Chosen.
const MISS_CHANCE: f64 = 0.005;

/// Greatest number of draws for each hypothesis. Chosen.
const N_DRAWS: usize = 10;

/// Effort of the plane search in an image. Chosen.
const IMAGE_EFFORT: SearchEffort = SearchEffort {
    n_hypotheses_max: 240,
    neighbours_agree: 0.3,
    n_local_fits: 3,
    n_fits: 2,
};

/// Draws of the hypotheses of an image: the same for all, so that the planes depend on the image
/// alone.
pub(crate) fn hypothesis_draws() -> Random {
    Random::from_seed(1)
}

/// Effort of a plane search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SearchEffort {
    /// Greatest number of hypotheses for one plane.
    pub(crate) n_hypotheses_max: usize,
    /// Assumed probability that the points drawn around an inlier make a good hypothesis.
    pub(crate) neighbours_agree: f64,
    /// Greatest number of least-squares fits of each new best hypothesis.
    pub(crate) n_local_fits: usize,
    /// Greatest number of least-squares fits of the best hypothesis to all samples.
    pub(crate) n_fits: usize,
}

impl SearchEffort {
    /// Adaptive number of RANSAC rounds for the inlier share found so far.
    fn rounds_needed(&self, n_inliers: u32, n: usize) -> usize {
        let hit = (self.neighbours_agree * f64::from(n_inliers) / n as f64).clamp(1e-6, 0.99);
        (MISS_CHANCE.ln() / (1.0 - hit).ln())
            .ceil()
            .min(self.n_hypotheses_max as f64) as usize
    }
}

/// Buffers of the plane search in an image.
#[derive(Debug, Default)]
pub(crate) struct PlaneSearchBuffers {
    free: Vec<u32>,
    counted: Samples,
}

/// Cone of accepted plane normals around up.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UpCone {
    /// Up direction, frame of the samples.
    pub(crate) up: Unit<Vector3<f64>>,
    /// Least cosine between the normal, or its opposite, and up.
    pub(crate) cos_min: f64,
}

impl UpCone {
    /// Plane oriented upwards; `None` when its normal is outside of the cone.
    pub(crate) fn admit(&self, plane: Plane) -> Option<Plane> {
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

/// Largest plane of an image, with three neighbouring samples for each hypothesis. Its
/// positive side holds the camera.
pub(crate) fn largest_plane_in_image(
    samples: &Samples,
    cone: Option<&UpCone>,
    n_min: usize,
    random: &mut Random,
    buffers: &mut PlaneSearchBuffers,
) -> Option<Plane> {
    let PlaneSearchBuffers { free, counted } = buffers;
    free.clear();
    free.extend((0..samples.len() as u32).filter(|&i| samples.is_unassigned(i as usize)));
    let draw = || drawn_neighbours(samples, free, random);
    let plane = largest_plane(samples, cone, n_min, &IMAGE_EFFORT, draw, counted)?;
    Some(plane.facing(&Point3::origin()))
}

/// Largest plane: the plane with the most unassigned samples in its band, refined by least
/// squares; `None` when no hypothesis has `n_min` inliers. `draw` draws the three samples of a
/// hypothesis, and gives `None` when it missed.
///
/// RANSAC (Fischler and Bolles 1981) with neighbouring points, local optimisation of each
/// new best hypothesis (Chum, Matas and Kittler 2003) and an adaptive number of rounds.
pub(crate) fn largest_plane(
    samples: &Samples,
    cone: Option<&UpCone>,
    n_min: usize,
    effort: &SearchEffort,
    mut draw: impl FnMut() -> Option<[usize; 3]>,
    counted: &mut Samples,
) -> Option<Plane> {
    let admit = |plane| cone.map_or(Some(plane), |cone| cone.admit(plane));
    let n_free = samples.n_unassigned();
    if n_free < n_min.max(3) {
        return None;
    }
    samples.subsample_into((n_free / N_COUNTED_AIMED).max(1), counted);
    let mut best: Option<(Plane, u32)> = None;
    let (mut round, mut n_rounds) = (0, effort.n_hypotheses_max);
    // A draw that misses costs little; on a narrow surface most do.
    for _ in 0..N_DRAWS * effort.n_hypotheses_max {
        if round >= n_rounds {
            break;
        }
        let Some(drawn) = draw() else { continue };
        round += 1;
        let [a, b, c] = drawn.map(|sample| samples.position(sample));
        let Some(plane) = Plane::through_points(&a, &b, &c).and_then(admit) else {
            continue;
        };
        let n_inliers = counted.count_inliers(&AffineForm::from(&plane));
        if best.as_ref().is_none_or(|&(_, n_best)| n_inliers > n_best) {
            let n_fits = effort.n_local_fits;
            let better = locally_optimised(counted, plane, n_inliers, n_fits, &admit);
            n_rounds = effort.rounds_needed(better.1, counted.len());
            best = Some(better);
        }
    }
    let plane = refined(samples, best?.0, effort.n_fits, &admit);
    let n_inliers = samples.count_inliers(&AffineForm::from(&plane)) as usize;
    (n_inliers >= n_min).then_some(plane)
}

/// Random sample and two of its neighbours.
fn drawn_neighbours(samples: &Samples, free: &[u32], random: &mut Random) -> Option<[usize; 3]> {
    let anchor = free[random.below(free.len())] as usize;
    let second = neighbour(samples, anchor, random)?;
    Some([anchor, second, neighbour(samples, anchor, random)?])
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
    n_fits: usize,
    admit: &impl Fn(Plane) -> Option<Plane>,
) -> (Plane, u32) {
    for _ in 0..n_fits {
        let Some(fitted) = fitted(counted, &plane).and_then(admit) else {
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
fn refined(
    samples: &Samples,
    mut plane: Plane,
    n_fits: usize,
    admit: &impl Fn(Plane) -> Option<Plane>,
) -> Plane {
    for _ in 0..n_fits {
        match fitted(samples, &plane).and_then(admit) {
            Some(better) => plane = better,
            None => break,
        }
    }
    plane
}

/// Least-squares plane of the inliers of another plane.
fn fitted(samples: &Samples, plane: &Plane) -> Option<Plane> {
    let moments = samples.inlier_moments(&AffineForm::from(plane));
    least_squares_plane(&moments.principal_axes()?)
}

/// Least-squares plane of points with these principal axes, of either orientation.
pub(crate) fn least_squares_plane(axes: &PrincipalAxes) -> Option<Plane> {
    let normal = Unit::try_new(axes.axes.column(2).into_owned(), 0.5)?;
    Some(Plane::through(&axes.centroid, normal))
}
