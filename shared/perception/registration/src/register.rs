//! Registration of two surfaces.

use crate::Error;
use crate::correspondence_score::{TOLERANCE_M, contradiction, contradictions};
use crate::generalized_icp::{Aligner, Alignment, Schedule};
use crate::prior::Prior;
use crate::surfels::Surfel;
use crate::view_surface::ViewSurface;
use crate::weak_rotation::WeakRotation;
use nalgebra::{Isometry3, Matrix6, Point3, Translation3};

/// Number of surfels of the first alignments, about. Chosen.
const N_COARSE: usize = 300;

/// Number of surfels of the last alignment, about. Chosen.
const N_FINE: usize = 1500;

/// Reach of the correspondences in the first step, metres: at most, and at least.
const REACH_M: std::ops::RangeInclusive<f64> = 0.012..=0.05;

/// Distance of correspondences that count as common surface, metres. Chosen.
const COMMON_M: f64 = 0.004;

/// Tolerances of the figures of a result in standard deviations of the views' noise, where these
/// are more: of the common surface, and of contradictions. Chosen: a Kinect at 1.8 m has 5 mm.
const COMMON_SIGMAS: f64 = 2.5;
const CONTRADICTION_SIGMAS: f64 = 2.0;

/// Last alignment, with all surfels.
const FINE_SCHEDULE: Schedule = Schedule {
    n_steps: 15,
    reach_m: [0.012, 0.006],
    factor: 0.85,
    rotation_min_rad: 1e-4,
};

/// Result of a registration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Registration {
    /// Pose of the source in the frame of the target.
    pub target_from_source: Isometry3<f64>,
    /// Share of the source's surface elements within 4 mm of the target, or within the noise of
    /// the views if that is more, 0 to 1.
    pub common_share: f64,
    /// Root mean square distance of these from the target's surface, metres.
    pub residual_m: f64,
    /// Contradiction of the two views, 0 to 2: how much of what one of them should have seen of
    /// the other is not where it was seen.
    pub contradiction: f64,
    /// Half of the contradiction, 0 to 1: how much of the target the source should have seen and did
    /// not. Surface that only the source has does not raise it.
    pub target_contradiction: f64,
    /// Mean difference of the colours of the common surface, 0 where they are equal to 1 where all
    /// are different; `None` without colours.
    pub color_difference: Option<f64>,
    /// `true` if a rotation was hardly constrained by the surfaces, and taken from the prior or
    /// from the points.
    pub is_rotation_weak: bool,
}

/// Alignment of a pair of views that are already near each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairAlignment {
    /// Pose of the source in the frame of the target.
    pub target_from_source: Isometry3<f64>,
    /// Centre of the source, in its own frame.
    pub centre: Point3<f64>,
    /// Curvature of half the squared distances across the surfaces, metres², for a rotation
    /// vector about the centre and then a translation, in the axes of the target: the information
    /// of the pair about each direction, for distances with a variance of 1 m².
    pub curvature: Matrix6<f64>,
    /// Contradiction of the two views, 0 to 2, as in [`Registration`].
    pub contradiction: f64,
}

/// Aligns a source surface with a target surface within 12 mm, by all surfels: the last step of a
/// registration.
///
/// *Cost*: some milliseconds for views of 10 000 points.
///
/// # Errors
/// When the surfaces have nothing in common at the prior.
pub fn refine(
    target: &ViewSurface,
    source: &ViewSurface,
    prior: &Prior,
) -> Result<PairAlignment, Error> {
    let aligner = Aligner {
        target,
        source: &thinned(source.surfels(), N_FINE),
        centre: source.centroid(),
        prior: prior.with_positive_sigmas(),
        held: None,
        grid: None,
    };
    let found = aligner.align(prior.target_from_source, &FINE_SCHEDULE);
    if !found.has_overlap() {
        let reach_mm = (1e3 * FINE_SCHEDULE.reach_m[0]) as u32;
        return Err(Error::NoOverlap { reach_mm });
    }
    Ok(PairAlignment {
        target_from_source: found.target_from_source,
        centre: source.centroid(),
        curvature: found.curvature,
        contradiction: described_contradictions(target, source, &found.target_from_source)
            .iter()
            .sum(),
    })
}

/// Registers a source surface with a target surface.
///
/// *Cost*: milliseconds for views of 10 000 points, some ten milliseconds more where a rotation
/// is weakly constrained.
///
/// # Errors
/// When the surfaces have nothing in common around the prior.
pub fn register(
    target: &ViewSurface,
    source: &ViewSurface,
    prior: &Prior,
) -> Result<Registration, Error> {
    let coarse = thinned(source.surfels(), N_COARSE);
    let aligner = Aligner {
        target,
        source: &coarse,
        centre: source.centroid(),
        prior: prior.with_positive_sigmas(),
        held: None,
        grid: None,
    };
    let (start, first) = best_start(&aligner, source, prior)?;
    let weak = WeakRotation::of(&first, &aligner);
    let fine = thinned(source.surfels(), N_FINE);
    let last = Aligner {
        source: &fine,
        held: weak.map(|weak| weak.axis.into_inner()),
        ..aligner
    };
    let mut pose = first.target_from_source;
    if weak.is_some() {
        let held = Aligner {
            held: last.held,
            ..aligner
        };
        let at_prior = held.align(start, &coarse_schedule(prior));
        let at_prior = last.align(at_prior.target_from_source, &FINE_SCHEDULE);
        pose = at_prior.target_from_source;
        // With colours the curvature has told that they do not constrain the turn either.
        let searched = WeakRotation::of(&at_prior, &aligner).filter(|_| !target.has_colors());
        if let Some(weak) = searched {
            pose = weak.search(&held, source, pose);
        }
    }
    let target_from_source = last.align(pose, &FINE_SCHEDULE).target_from_source;
    Ok(described(
        target,
        source,
        target_from_source,
        weak.is_some(),
    ))
}

/// Start that leads to the least contradiction, and its alignment: the prior, or the prior with
/// the centroids brought together if that is probable.
fn best_start(
    aligner: &Aligner<'_>,
    source: &ViewSurface,
    prior: &Prior,
) -> Result<(Isometry3<f64>, Alignment), Error> {
    let at_prior = prior.target_from_source;
    let shift = aligner.target.centroid() - at_prior * source.centroid();
    let centred = Translation3::from(shift) * at_prior;
    let is_probable = shift.norm() < 3.0 * prior.translation_sigma_m;
    let mut best: Option<(f64, Isometry3<f64>, Alignment)> = None;
    for start in std::iter::once(at_prior).chain(is_probable.then_some(centred)) {
        let alignment = aligner.align(start, &coarse_schedule(prior));
        if !alignment.has_overlap() {
            continue;
        }
        let pose = &alignment.target_from_source;
        let score = contradiction(aligner.target, source, pose, TOLERANCE_M);
        if best.as_ref().is_none_or(|(least, ..)| score < *least) {
            best = Some((score, start, alignment));
        }
    }
    let (_, start, alignment) = best.ok_or_else(|| Error::NoOverlap {
        reach_mm: (1e3 * reach_m(prior)) as u32,
    })?;
    Ok((start, alignment))
}

/// Reach of the correspondences in the first step: three standard deviations of the prior.
fn reach_m(prior: &Prior) -> f64 {
    (3.0 * prior.translation_sigma_m).clamp(*REACH_M.start(), *REACH_M.end())
}

fn coarse_schedule(prior: &Prior) -> Schedule {
    Schedule {
        n_steps: 30,
        reach_m: [reach_m(prior), 0.010],
        factor: 0.85,
        rotation_min_rad: 1e-3,
    }
}

/// Evenly strided surfels, about as many as wanted.
pub(crate) fn thinned(surfels: &[Surfel], n_wanted: usize) -> Vec<Surfel> {
    let step = (surfels.len() / n_wanted).max(1);
    surfels.iter().step_by(step).copied().collect()
}

fn described(
    target: &ViewSurface,
    source: &ViewSurface,
    target_from_source: Isometry3<f64>,
    is_rotation_weak: bool,
) -> Registration {
    let (mut sum, mut n_common) = (0.0, 0.0);
    let (mut color_sum, mut n_colored) = (0.0, 0.0);
    let common_m = COMMON_M.max(COMMON_SIGMAS * noise_m(target, source));
    for surfel in source.surfels() {
        let place = target_from_source * surfel.place;
        if let Some((nearest, _)) = target.nearest_surfel(&place, common_m) {
            sum += (nearest.place - place).dot(&nearest.normal).powi(2);
            n_common += 1.0;
            if let Some((color, other)) = surfel.color.zip(nearest.color) {
                color_sum += other.disagreement(&color, &(place - nearest.place));
                n_colored += 1.0;
            }
        }
    }
    let [source_contradiction, target_contradiction] =
        described_contradictions(target, source, &target_from_source);
    Registration {
        target_from_source,
        common_share: n_common / source.surfels().len() as f64,
        residual_m: (sum / f64::max(n_common, 1.0)).sqrt(),
        contradiction: source_contradiction + target_contradiction,
        target_contradiction,
        color_difference: (n_colored > 0.0).then(|| color_sum / n_colored),
        is_rotation_weak,
    }
}

/// Contradictions of the source and of the target, whose sum is that of the views, with a tolerance
/// that is no less than their noise.
fn described_contradictions(
    target: &ViewSurface,
    source: &ViewSurface,
    target_from_source: &Isometry3<f64>,
) -> [f64; 2] {
    let tolerance_m = TOLERANCE_M.max(CONTRADICTION_SIGMAS * noise_m(target, source));
    contradictions(target, source, target_from_source, tolerance_m)
}

/// Noise of the noisier of two views, metres.
fn noise_m(target: &ViewSurface, source: &ViewSurface) -> f64 {
    target.noise_m().max(source.noise_m())
}

#[cfg(test)]
mod tests;
