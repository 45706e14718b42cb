//! Damped least squares inverse kinematics (Levenberg–Marquardt) within joint limits.

use geometry::RigidTransform;
use nalgebra::{SMatrix, SVector};

use crate::{JointVector, KinematicChain, N_JOINTS, PoseResidual};

/// Length by which a rotation of one radian is weighted against translation, metres. Chosen.
const ROTATION_WEIGHT_M: f64 = 0.2;

/// Largest change of a joint in one iteration, radians; beyond it the linear model is a poor
/// approximation. Chosen.
const MAX_STEP_RAD: f64 = 0.5;

/// Convergence threshold of the weighted pose error, metres. Chosen.
const CONVERGED_M: f64 = 1e-10;

/// Least relative reduction of the error that counts as progress. Chosen.
const MIN_PROGRESS: f64 = 1e-7;

/// Lower limit of the adaptive damping. Chosen.
const MIN_DAMPING: f64 = 1e-9;
/// Upper limit of the adaptive damping; the search ends there. Chosen.
const MAX_DAMPING: f64 = 1e3;

/// Result of the damped least squares iteration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeastSquaresSolution {
    pub(crate) joints_rad: JointVector,
    pub(crate) residual: PoseResidual,
    pub(crate) n_iterations: usize,
}

/// Iterates from `start` towards the pose within the joint limits, in at most `max_iterations`
/// iterations.
///
/// Damped least squares (Wampler 1986; Nakamura and Hanafusa 1986) with adaptive damping
/// (Marquardt 1963). A joint at its limit that would be pushed outwards is left out of the step.
pub(crate) fn solve_least_squares(
    chain: &KinematicChain,
    base_from_tool: &RigidTransform,
    start: &JointVector,
    max_iterations: usize,
) -> LeastSquaresSolution {
    let mut joints = chain.clamped(start);
    let mut poses = chain.forward(&joints);
    let mut error = weighted_error(base_from_tool, &poses.base_from_tool);
    let mut damping = 1e-4;
    let mut n_iterations = 0;
    while n_iterations < max_iterations && error.norm() > CONVERGED_M && damping < MAX_DAMPING {
        n_iterations += 1;
        let step = damped_step(
            chain,
            &joints,
            &weighted(chain.jacobian(&poses)),
            &error,
            damping,
        );
        let moved = chain.clamped(&(joints + step));
        let moved_poses = chain.forward(&moved);
        let moved_error = weighted_error(base_from_tool, &moved_poses.base_from_tool);
        if moved_error.norm() < error.norm() {
            let progress = 1.0 - moved_error.norm() / error.norm();
            (joints, poses, error) = (moved, moved_poses, moved_error);
            damping = (damping * 0.2).max(MIN_DAMPING);
            if progress < MIN_PROGRESS {
                break;
            }
        } else {
            damping *= 8.0;
        }
    }
    LeastSquaresSolution {
        joints_rad: joints,
        residual: PoseResidual::between(base_from_tool, &poses.base_from_tool),
        n_iterations,
    }
}

/// Computes one damped Gauss–Newton step: solves `(JᵀJ + damping) step = Jᵀ error` over the
/// joints that are free to move.
fn damped_step(
    chain: &KinematicChain,
    joints: &JointVector,
    jacobian: &SMatrix<f64, 6, N_JOINTS>,
    error: &SVector<f64, 6>,
    damping: f64,
) -> JointVector {
    let mut free = *jacobian;
    let downhill = jacobian.tr_mul(error);
    for (i, joint) in chain.joints.iter().enumerate() {
        let is_held = (joints[i] <= joint.min_rad && downhill[i] < 0.0)
            || (joints[i] >= joint.max_rad && downhill[i] > 0.0);
        if is_held {
            free.column_mut(i).fill(0.0);
        }
    }
    let normal = free.tr_mul(&free) + SMatrix::<f64, N_JOINTS, N_JOINTS>::identity() * damping;
    let Some(factors) = normal.cholesky() else {
        return JointVector::zeros();
    };
    let step = factors.solve(&free.tr_mul(error));
    let largest = step.amax();
    if largest > MAX_STEP_RAD {
        step * (MAX_STEP_RAD / largest)
    } else {
        step
    }
}

/// Weighted pose error: translation and scaled rotation vector from `reached` to `wanted`, base
/// frame, metres.
fn weighted_error(wanted: &RigidTransform, reached: &RigidTransform) -> SVector<f64, 6> {
    let shift = wanted.translation.vector - reached.translation.vector;
    let turn = (wanted.rotation * reached.rotation.inverse()).scaled_axis() * ROTATION_WEIGHT_M;
    SVector::<f64, 6>::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

fn weighted(mut jacobian: SMatrix<f64, 6, N_JOINTS>) -> SMatrix<f64, 6, N_JOINTS> {
    jacobian.fixed_rows_mut::<3>(3).scale_mut(ROTATION_WEIGHT_M);
    jacobian
}
