//! Generalised ICP: alignment of surfels plane to plane.

use crate::nearest_surfel_grid::NearestSurfelGrid;
use crate::prior::Prior;
use crate::surfels::Surfel;
use crate::twist::{Twist, motion_about, twist_at};
use crate::view_surface::ViewSurface;
use nalgebra::{Isometry3, Matrix3, Matrix3x6, Matrix6, Point3, Vector3, Vector6};

/// Weight of a distance along the surfaces against one across them. Fitted: with less, flat
/// surfaces slide; with more, curved ones are off.
const TANGENTIAL_WEIGHT: f64 = 0.02;

/// Cosine of the greatest angle between the normals of a correspondence, 53°. Chosen.
const NORMALS_COSINE_MIN: f64 = 0.6;

/// Standard deviation of a correspondence across the surfaces, metres, against which the prior is
/// weighed. Measured: 0.8 mm on the noise of a Kinect at 0.7 m.
const RESIDUAL_SIGMA_M: f64 = 0.001;

/// Minimum number of correspondences of a step.
const N_CORRESPONDENCES_MIN: usize = 10;

/// Schedule of an alignment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Schedule {
    pub(crate) n_steps: usize,
    /// Reach of the correspondences in the first step and in the last ones, metres. The first
    /// shrinks by a factor from step to step.
    pub(crate) reach_m: [f64; 2],
    pub(crate) factor: f64,
    /// Rotation of a step, radians, below which the alignment ends.
    pub(crate) rotation_min_rad: f64,
}

/// Result of an alignment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Alignment {
    pub(crate) target_from_source: Isometry3<f64>,
    /// Curvature of half the squared distances across the surfaces in the last step: what the
    /// surfaces themselves tell about each direction.
    pub(crate) curvature: Matrix6<f64>,
    pub(crate) n_correspondences: usize,
}

impl Alignment {
    /// `true` if there were correspondences enough for a step.
    pub(crate) fn has_overlap(&self) -> bool {
        self.n_correspondences >= N_CORRESPONDENCES_MIN
    }
}

/// Alignment of one surface with another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Aligner<'a> {
    pub(crate) target: &'a ViewSurface,
    /// Surfels of the source that take part.
    pub(crate) source: &'a [Surfel],
    /// Centre of the rotations, in the source.
    pub(crate) centre: Point3<f64>,
    pub(crate) prior: Prior,
    /// Rotation axis about which the pose is held.
    pub(crate) held: Option<Vector3<f64>>,
    /// Lookup of the target's surfels in place of the exact search.
    pub(crate) grid: Option<&'a NearestSurfelGrid>,
}

/// Normal equations of one step.
struct NormalEquations {
    matrix: Matrix6<f64>,
    curvature: Matrix6<f64>,
    vector: Vector6<f64>,
    n_correspondences: usize,
    color_offset: MeanColor,
}

/// Weighted mean difference of the colours: the exposure of one view against the other.
#[derive(Debug, Clone, Copy, Default)]
struct MeanColor {
    sum: Vector3<f64>,
    weight: f64,
}

impl MeanColor {
    fn add(&mut self, difference: &Vector3<f64>, weight: f64) {
        self.sum += weight * difference;
        self.weight += weight;
    }

    fn mean(&self) -> Vector3<f64> {
        self.sum / self.weight.max(f64::MIN_POSITIVE)
    }
}

impl Aligner<'_> {
    /// Aligns from a pose; fewer than ten correspondences leave it as it is.
    pub(crate) fn align(&self, start: Isometry3<f64>, schedule: &Schedule) -> Alignment {
        let mut alignment = Alignment {
            target_from_source: start,
            curvature: Matrix6::zeros(),
            n_correspondences: 0,
        };
        let [mut reach_m, reach_min_m] = schedule.reach_m;
        let mut color_offset = Vector3::zeros();
        for _ in 0..schedule.n_steps {
            let pose = alignment.target_from_source;
            let equations = self.normal_equations(&pose, reach_m.max(reach_min_m), &color_offset);
            color_offset = equations.color_offset.mean();
            alignment.curvature = equations.curvature;
            alignment.n_correspondences = equations.n_correspondences;
            if !alignment.has_overlap() {
                break;
            }
            let Some(change) = self.solve(&equations, &pose) else {
                break;
            };
            alignment.target_from_source = motion_about(&change, &(pose * self.centre)) * pose;
            let (rotation, translation) = (change.fixed_rows::<3>(0), change.fixed_rows::<3>(3));
            let is_small = rotation.norm() < schedule.rotation_min_rad
                && translation.norm() < 0.05 * schedule.rotation_min_rad;
            if is_small && reach_m <= reach_min_m {
                break;
            }
            reach_m *= schedule.factor;
        }
        alignment
    }

    fn normal_equations(
        &self,
        pose: &Isometry3<f64>,
        reach_m: f64,
        color_offset: &Vector3<f64>,
    ) -> NormalEquations {
        let mut equations = NormalEquations {
            matrix: Matrix6::zeros(),
            curvature: Matrix6::zeros(),
            vector: Vector6::zeros(),
            n_correspondences: 0,
            color_offset: MeanColor::default(),
        };
        let centre = pose * self.centre;
        for surfel in self.source {
            let place = pose * surfel.place;
            let Some((target, squared)) = self.nearest(&place, reach_m) else {
                continue;
            };
            let normal = pose.rotation * surfel.normal;
            if normal.dot(&target.normal).abs() < NORMALS_COSINE_MIN {
                continue;
            }
            // Tukey's biweight of the distance.
            let closeness = 1.0 - squared / (reach_m * reach_m);
            let weight = target.flatness.min(surfel.flatness) * closeness * closeness;
            let metric = weight * plane_metric(&target.normal, &normal);
            let mut jacobian = Matrix3x6::zeros();
            let lever = (place - centre).cross_matrix();
            jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&-lever);
            jacobian.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
            let weighted = jacobian.transpose() * metric;
            equations.matrix += weighted * jacobian;
            equations.vector += weighted * (target.place - place);
            let across = jacobian.transpose() * target.normal;
            equations.curvature += weight * across * across.transpose();
            equations.n_correspondences += 1;
            if let Some((target_color, source_color)) = target.color.zip(surfel.color) {
                let off = target_color.difference(&source_color, &(place - target.place));
                equations.color_offset.add(&off, weight);
                let off = off - color_offset;
                let (slope, off) = target_color.equations(&off, &jacobian, RESIDUAL_SIGMA_M);
                let squared = weight * slope.transpose() * slope;
                equations.matrix += squared;
                equations.curvature += squared;
                equations.vector += weight * slope.transpose() * off;
            }
        }
        equations
    }

    /// Surfel of the target that corresponds to a place, with the squared distance.
    fn nearest(&self, place: &Point3<f64>, reach_m: f64) -> Option<(&Surfel, f64)> {
        let Some(grid) = self.grid else {
            return self.target.nearest_surfel(place, reach_m);
        };
        let near = grid.near(self.target.surfels(), place)?;
        let squared = (near.place - place).norm_squared();
        (squared < reach_m * reach_m).then_some((near, squared))
    }

    /// Change of the pose that solves the normal equations with the prior.
    fn solve(&self, equations: &NormalEquations, pose: &Isometry3<f64>) -> Option<Twist> {
        let (mut matrix, mut vector) = (equations.matrix, equations.vector);
        let prior = &self.prior.target_from_source;
        let off = twist_at(&(pose * prior.inverse()), &(prior * self.centre));
        let sigmas = [
            self.prior.rotation_sigma_rad,
            self.prior.translation_sigma_m,
        ];
        for axis in 0..6 {
            let weight = (RESIDUAL_SIGMA_M / sigmas[axis / 3]).powi(2);
            matrix[(axis, axis)] += weight;
            vector[axis] -= weight * off[axis];
        }
        if let Some(axis) = self.held {
            let mut held = Twist::zeros();
            held.fixed_rows_mut::<3>(0).copy_from(&axis);
            matrix += 1e3 * matrix.trace() * held * held.transpose();
        }
        Some(matrix.cholesky()?.solve(&vector))
    }
}

/// Metric of a distance between two surfels: the inverse sum of their covariances, which are 1
/// along the surface and the tangential weight across it. Scaled so that a distance across two
/// parallel surfels counts one.
fn plane_metric(target: &Vector3<f64>, source: &Vector3<f64>) -> Matrix3<f64> {
    let across = 1.0 - TANGENTIAL_WEIGHT;
    let normals = target * target.transpose() + source * source.transpose();
    let covariance: Matrix3<f64> = 2.0 * Matrix3::identity() - across * normals;
    // Both covariances are positive definite.
    let inverse = covariance.try_inverse().unwrap_or_else(Matrix3::zeros);
    2.0 * TANGENTIAL_WEIGHT * inverse
}
