//! Weakly constrained rotation: the turn of a can about its axis.

use crate::correspondence_score::point_distance;
use crate::generalized_icp::{Aligner, Alignment, Schedule};
use crate::near_grid::NearGrid;
use crate::view_surface::ViewSurface;
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, UnitVector3, Vector3};

/// Share of the weakest rotation in the curvature of all below which it is weak, for a prior with
/// a standard deviation of 10°; a prior that is surer by a factor holds more by this factor, up to
/// the maximum. Fitted: the share is 0.004 for a cup, 0.02 for a can, whose noise looks like a
/// constraint, and 0.03 or more for what has edges.
const CURVATURE_SHARE_AT_10_DEG: f64 = 0.015;
const CURVATURE_SHARE_MAX: f64 = 0.05;

/// Step of the search over the turn, radians. Chosen: finer than the width of the optimum.
const STEP_RAD: f64 = 1.25_f64.to_radians();

/// Greatest turn from the prior that is searched.
const TURN_MAX_RAD: f64 = 30.0_f64.to_radians();

/// Reach of the points' distances as a multiple of their spacing. Chosen; 1.3 to 2 do as well.
const REACH_IN_SPACINGS: f64 = 1.75;

/// Share of near points below which a turn is no candidate, relative to the best. Chosen.
const NEAR_SHARE_MIN: f64 = 0.7;

/// Number of turns to either side that a turn is compared with.
const N_AROUND: usize = 5;

/// Difference to the turns around it, in robust standard deviations, that the best turn needs to
/// replace that of the prior. Chosen: noise alone reaches about 3.
const SIGNIFICANCE_MIN: f64 = 4.0;

/// Screw motion about the weakest axis: the rotation with the translation that costs least.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WeakRotation {
    pub(crate) axis: UnitVector3<f64>,
    /// Point of the axis, in the frame of the target.
    on_axis: Vector3<f64>,
    /// Translation along the axis, metres a radian.
    pitch: f64,
}

impl WeakRotation {
    /// Weak rotation after an alignment; `None` if all rotations are well constrained.
    pub(crate) fn of(alignment: &Alignment, aligner: &Aligner<'_>) -> Option<Self> {
        let centre = alignment.target_from_source * aligner.centre;
        let matrix = &alignment.curvature;
        let rotation: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into();
        let coupling: Matrix3<f64> = matrix.fixed_view::<3, 3>(3, 0).into();
        let translation: Matrix3<f64> = matrix.fixed_view::<3, 3>(3, 3).into();
        let follow = -translation.try_inverse()? * coupling;
        // Schur complement: the translation follows the rotation.
        let curvature = (rotation + coupling.transpose() * follow).symmetric_eigen();
        let weakest = curvature.eigenvalues.imin();
        let share = curvature.eigenvalues[weakest] / curvature.eigenvalues.sum();
        let certainty = 10_f64.to_radians() / aligner.prior.rotation_sigma_rad;
        if share > (CURVATURE_SHARE_AT_10_DEG * certainty).min(CURVATURE_SHARE_MAX) {
            return None;
        }
        let axis = UnitVector3::new_normalize(curvature.eigenvectors.column(weakest).into_owned());
        let rate = follow * axis.into_inner();
        Some(Self {
            axis,
            on_axis: centre.coords + axis.cross(&rate),
            pitch: axis.dot(&rate),
        })
    }

    /// Turn by an angle.
    fn turn(&self, angle_rad: f64) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_axis_angle(&self.axis, angle_rad);
        let along = self.pitch * angle_rad * self.axis.into_inner();
        let shift = self.on_axis + along - rotation * self.on_axis;
        Isometry3::from_parts(Translation3::from(shift), rotation)
    }

    /// Pose of the turn that the points prefer, if they clearly prefer one, else the start. The
    /// aligner holds the turn.
    ///
    /// The number of correspondences is no score for this: it turns two views that share only a
    /// part of the surface one over the other. The mean distance of the points that are near each
    /// other is least where the same details lie on each other.
    pub(crate) fn search(
        &self,
        aligner: &Aligner<'_>,
        source: &ViewSurface,
        start: Isometry3<f64>,
    ) -> Isometry3<f64> {
        let target = aligner.target;
        let reach_m = REACH_IN_SPACINGS * target.spacing_m();
        let grid = NearGrid::new(target.points(), reach_m as f32);
        let candidate = |pose| Candidate::new(pose, &grid, source.points());
        let schedule = Schedule {
            n_steps: 3,
            reach_m: [0.006; 2],
            factor: 1.0,
            rotation_min_rad: 1e-3,
        };
        let turn_max = TURN_MAX_RAD.min(3.0 * aligner.prior.rotation_sigma_rad);
        let n_steps = (turn_max / STEP_RAD).ceil() as i32;
        let turned = |pose: &Isometry3<f64>, angle: f64| self.turn(angle) * pose;
        let candidates: Vec<Candidate> = (-n_steps..=n_steps)
            .map(|i| {
                let pose = turned(&start, f64::from(i) * STEP_RAD);
                let pose = aligner.align(pose, &schedule).target_from_source;
                candidate(pose)
            })
            .collect();
        let Some(best) = best_candidate(&candidates) else {
            return start;
        };
        let finer = [-0.5, -0.25, 0.0, 0.25, 0.5].map(|part| {
            let pose = turned(&best.target_from_source, part * STEP_RAD);
            candidate(pose)
        });
        let by_distance = |a: &Candidate, b: &Candidate| a.distance.total_cmp(&b.distance);
        let finest = finer.into_iter().min_by(by_distance);
        finest.map_or(start, |candidate| candidate.target_from_source)
    }
}

/// Pose with the distance of its points.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    target_from_source: Isometry3<f64>,
    distance: f64,
    near_share: f64,
}

impl Candidate {
    fn new(target_from_source: Isometry3<f64>, target: &NearGrid, source: &[[f32; 3]]) -> Self {
        let (distance, near_share) = point_distance(target, source, &target_from_source);
        Self {
            target_from_source,
            distance,
            near_share,
        }
    }
}

/// Candidate whose distance is least in comparison with those of the turns around it, if that is
/// significant. How much of the views coincides changes slowly with the turn; the same details
/// lie on each other in a narrow range only.
fn best_candidate(candidates: &[Candidate]) -> Option<&Candidate> {
    let greatest = candidates.iter().map(|c| c.near_share).fold(0.0, f64::max);
    let dip = |(i, candidate): (usize, &Candidate)| {
        let first = i.saturating_sub(N_AROUND);
        let end = (i + N_AROUND + 1).min(candidates.len());
        let around = median(candidates[first..end].iter().map(|c| c.distance).collect());
        around.map_or(0.0, |usual| usual - candidate.distance)
    };
    let dips: Vec<f64> = candidates.iter().enumerate().map(dip).collect();
    let is_near =
        |(candidate, _): &(&Candidate, &f64)| candidate.near_share >= NEAR_SHARE_MIN * greatest;
    let by_dip = |a: &(&Candidate, &f64), b: &(&Candidate, &f64)| a.1.total_cmp(b.1);
    let (best, deepest) = candidates
        .iter()
        .zip(&dips)
        .filter(is_near)
        .max_by(by_dip)?;
    // Median absolute deviation of a normal distribution.
    let sigma = 1.4826 * median(dips.iter().map(|dip| dip.abs()).collect())?;
    (*deepest > SIGNIFICANCE_MIN * sigma).then_some(best)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
