//! Descent of the joint angles towards a pose.

use geometry::RigidTransform;
use nalgebra::{SMatrix, SVector};

use crate::{JointVector, KinematicChain, N_JOINTS, PoseResidual};

/// A turn of one radian weighs as much as this length, metres.
const TURN_LEVER_M: f64 = 0.2;

/// Largest change of a joint in one step, radians: beyond it the linear model says little.
const MAX_STEP_RAD: f64 = 0.5;

/// Weighted pose error at which nothing is left to improve, metres.
const FINISHED_M: f64 = 1e-10;

/// Least share by which a step must shorten the error to count as progress.
const LEAST_PROGRESS: f64 = 1e-7;

const LEAST_DAMPING: f64 = 1e-9;
const GREATEST_DAMPING: f64 = 1e3;

/// Where a descent ended.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Descent {
    pub(crate) joints_rad: JointVector,
    pub(crate) residual: PoseResidual,
    pub(crate) n_iterations: usize,
}

/// Descends from `start` to the nearest pose that the chain can reach within
/// its limits from there, in at most `max_iterations` steps.
///
/// Damped least squares (Wampler 1986; Nakamura and Hanafusa 1986) with the
/// damping adapted from step to step (Marquardt 1963). A joint at its limit that
/// would be pushed outwards is left out of the step.
pub(crate) fn descend(
    chain: &KinematicChain,
    base_from_tool: &RigidTransform,
    start: &JointVector,
    max_iterations: usize,
) -> Descent {
    let mut joints = chain.clamped(start);
    let mut poses = chain.forward(&joints);
    let mut error = weighted_error(base_from_tool, &poses.base_from_tool);
    let mut damping = 1e-4;
    let mut n_iterations = 0;
    while n_iterations < max_iterations && error.norm() > FINISHED_M && damping < GREATEST_DAMPING {
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
            damping = (damping * 0.2).max(LEAST_DAMPING);
            if progress < LEAST_PROGRESS {
                break;
            }
        } else {
            damping *= 8.0;
        }
    }
    Descent {
        joints_rad: joints,
        residual: PoseResidual::between(base_from_tool, &poses.base_from_tool),
        n_iterations,
    }
}

/// Solves `(JᵀJ + damping) step = Jᵀ error` over the joints that are free to move.
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

/// Translation and rotation vector from `reached` to `wanted`, base frame, in metres.
fn weighted_error(wanted: &RigidTransform, reached: &RigidTransform) -> SVector<f64, 6> {
    let shift = wanted.translation.vector - reached.translation.vector;
    let turn = (wanted.rotation * reached.rotation.inverse()).scaled_axis() * TURN_LEVER_M;
    SVector::<f64, 6>::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

fn weighted(mut jacobian: SMatrix<f64, 6, N_JOINTS>) -> SMatrix<f64, 6, N_JOINTS> {
    jacobian.fixed_rows_mut::<3>(3).scale_mut(TURN_LEVER_M);
    jacobian
}
