//! Closed-form inverse kinematics for an arm with a spherical wrist (Pieper 1968).

use geometry::RigidTransform;
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::f64::consts::PI;

use crate::{ArmDimensions, JointVector};

/// Greatest number of solution branches of one pose: shoulder front or back, elbow up or down,
/// wrist flipped or not.
pub(crate) const N_BRANCHES: usize = 8;

/// Sine of the wrist bend below which joints 4 and 6 are treated as collinear (wrist
/// singularity). Chosen.
const ALIGNED_SINE: f64 = 1e-9;

/// Computes all closed-form solutions of a tool pose, ignoring joint limits, each within one
/// turn. Beyond reach, the arm stretches (or folds) towards the pose as far as possible, so that
/// the angles still are a good initial guess.
///
/// The first three joints place the wrist centre, the last three orient the tool (Pieper 1968).
/// When the wrist is stretched, joint 4 stays at `near`.
pub(crate) fn solution_branches(
    dimensions: &ArmDimensions,
    base_from_tool: &RigidTransform,
    near: &JointVector,
) -> [JointVector; N_BRANCHES] {
    let approach = base_from_tool.rotation * Vector3::z();
    let wrist = base_from_tool.translation.vector - approach * dimensions.wrist_to_tool_m();
    let direction = base_from_tool.rotation.to_rotation_matrix();
    let mut found = [JointVector::zeros(); N_BRANCHES];
    for (i, joints) in found.iter_mut().enumerate() {
        let (is_behind, is_elbow_down, is_flipped) = (i & 4 != 0, i & 2 != 0, i & 1 != 0);
        let [q1, q2, q3] = arm_angles(dimensions, &wrist, is_behind, is_elbow_down);
        let base_from_forearm = Rotation3::from_axis_angle(&Vector3::z_axis(), q1)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), q2 + q3);
        let forearm_from_tool = base_from_forearm.inverse() * direction;
        let [q4, q5, q6] = wrist_angles(forearm_from_tool.matrix(), is_flipped, near[3]);
        *joints = JointVector::from([q1, q2, q3, q4, q5, q6]);
    }
    found
}

/// Joints 1 to 3 from the wrist position in the base frame.
fn arm_angles(
    dimensions: &ArmDimensions,
    wrist: &Vector3<f64>,
    is_behind: bool,
    is_elbow_down: bool,
) -> [f64; 3] {
    let (upper, fore) = (dimensions.upper_arm_m, dimensions.elbow_to_wrist_m());
    let lateral = -dimensions.elbow_offset_m;
    let forward = (wrist.x * wrist.x + wrist.y * wrist.y - lateral * lateral)
        .max(0.0)
        .sqrt();
    let forward = if is_behind { -forward } else { forward };
    let q1 = wrist.y.atan2(wrist.x) - lateral.atan2(forward);
    let up = wrist.z - dimensions.base_m;
    let cosine = (forward * forward + up * up - upper * upper - fore * fore) / (2.0 * upper * fore);
    let bend = cosine.clamp(-1.0, 1.0).acos();
    let q3 = if is_elbow_down { -bend } else { bend };
    let q2 = forward.atan2(up) - (fore * q3.sin()).atan2(upper + fore * q3.cos());
    [q1, q2, q3]
}

/// Joints 4 to 6: z-y-z Euler angles of the tool's rotation in the forearm frame.
fn wrist_angles(forearm_from_tool: &Matrix3<f64>, is_flipped: bool, near_q4: f64) -> [f64; 3] {
    let m = forearm_from_tool;
    let sine = m[(0, 2)].hypot(m[(1, 2)]);
    let q5 = sine.atan2(m[(2, 2)]);
    if sine < ALIGNED_SINE {
        // With collinear axes only the sum (or the difference) of joints 4 and 6 is determined.
        let turned = m[(1, 0)].atan2(m[(1, 1)]);
        let q6 = if m[(2, 2)] > 0.0 {
            turned - near_q4
        } else {
            turned + near_q4
        };
        return [near_q4, q5, q6];
    }
    let q4 = m[(1, 2)].atan2(m[(0, 2)]);
    let q6 = m[(2, 1)].atan2(-m[(2, 0)]);
    if is_flipped {
        [q4 + PI, -q5, q6 + PI]
    } else {
        [q4, q5, q6]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Arm, PoseResidual};

    #[test]
    fn every_branch_reaches_the_pose_also_with_an_aligned_wrist() {
        let arm = Arm::jaco_like();
        let near = JointVector::repeat(0.3);
        for bend in [0.0, 1e-12, 0.8, -2.0, PI] {
            for elbow in [-1.1, 0.4, 2.0] {
                let joints = JointVector::from([0.5, -0.3, elbow, 1.2, bend, -0.7]);
                let pose = arm.tool_pose(&joints);
                for found in solution_branches(arm.dimensions(), &pose, &near) {
                    let missed = PoseResidual::between(&pose, &arm.tool_pose(&found));
                    assert!(
                        missed.distance_m < 1e-9 && missed.angle_rad < 1e-7,
                        "{missed:?}"
                    );
                }
            }
        }
    }
}
