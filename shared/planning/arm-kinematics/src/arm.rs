//! Robot arm: kinematic chain, dimensions and gripper in one model.

use geometry::RigidTransform;
use nalgebra::{Translation3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

use crate::{
    ArmDimensions, GripperModel, Joint, JointVector, KinematicChain, N_JOINTS, tool_from_fingers,
};

/// Home position (folded), joint angles in radians. The upper arm leans back, the forearm is
/// level above it, the tool is 0.36 m above the mounting plate and 0.14 m in front of it,
/// pointing forward and down, and the fingers close sideways. No part of the arm is farther than
/// 0.2 m in front of its base, so that a camera above the table does not see it. Chosen.
pub const HOME: [f64; N_JOINTS] = [0.0, -0.9, 2.5, 0.0, 0.7, FRAC_PI_2];

/// Robot arm with gripper: kinematic chain, dimensions and gripper geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    chain: KinematicChain,
    dimensions: ArmDimensions,
    gripper: GripperModel,
}

/// Poses of all bodies of the arm, base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyPoses {
    /// Link poses: the base, then the link behind each joint.
    pub base_from_link: [RigidTransform; N_JOINTS + 1],
    /// Tool pose; the gripper's rail is given in this frame.
    pub base_from_tool: RigidTransform,
    /// Finger poses: the finger at +x of the tool, then the finger at -x.
    pub base_from_finger: [RigidTransform; 2],
}

impl Arm {
    /// Arm with the link lengths of the six-joint Kinova JACO.
    ///
    /// At zero angles the arm is stretched straight up, with all link frames parallel to the base
    /// frame. Joints 1, 4 and 6 rotate about the arm's length (z), joints 2, 3 and 5 bend it (y).
    ///
    /// The JACO's wrist has two bends of 60° and its axes do not meet. Here the axes of joints 4
    /// to 6 meet in one point (spherical wrist), with the same link lengths. Arm and wrist angles
    /// can therefore be found one after the other in closed form (Pieper 1968), which finds every
    /// solution or proves that there is none.
    ///
    /// Limits: shoulder ±133° and elbow ±161° as the JACO's, which counts them from 180°; wrist
    /// bend ±150° as Kinova's spherical wrist; the continuous joints of the JACO have ±360°.
    /// Velocities are the JACO's 36 °/s for the three large and 48 °/s for the three small
    /// actuators; accelerations are chosen so that full velocity takes 0.4 s.
    pub fn jaco_like() -> Self {
        Self::new(ArmDimensions::JACO_LIKE, GripperModel::JACO_LIKE)
    }

    /// Arm of the same structure with other link lengths.
    pub fn new(dimensions: ArmDimensions, gripper: GripperModel) -> Self {
        let d = &dimensions;
        let (large, small) = (36.0_f64.to_radians(), 48.0_f64.to_radians());
        let up = |length_m| Vector3::new(0.0, 0.0, length_m);
        let forearm = Vector3::new(0.0, -d.elbow_offset_m, d.forearm_m);
        let joints = [
            joint(up(d.base_joint_height_m()), Vector3::z_axis(), TAU, large),
            joint(
                up(d.base_m - d.base_joint_height_m()),
                Vector3::y_axis(),
                133.0_f64.to_radians(),
                large,
            ),
            joint(
                up(d.upper_arm_m),
                Vector3::y_axis(),
                161.0_f64.to_radians(),
                large,
            ),
            joint(forearm, Vector3::z_axis(), TAU, small),
            joint(
                up(d.first_wrist_m),
                Vector3::y_axis(),
                150.0_f64.to_radians(),
                small,
            ),
            joint(up(d.second_wrist_m), Vector3::z_axis(), TAU, small),
        ];
        let last_link_from_tool = Translation3::from(up(d.hand_m)).into();
        Self {
            chain: KinematicChain {
                joints,
                last_link_from_tool,
            },
            dimensions,
            gripper,
        }
    }

    /// Kinematic chain of the arm.
    pub fn chain(&self) -> &KinematicChain {
        &self.chain
    }

    /// Link lengths of the arm.
    pub fn dimensions(&self) -> &ArmDimensions {
        &self.dimensions
    }

    /// Gripper geometry of the arm.
    pub fn gripper(&self) -> &GripperModel {
        &self.gripper
    }

    /// Tool pose (forward kinematics), `base_from_tool`.
    pub fn tool_pose(&self, joints_rad: &JointVector) -> RigidTransform {
        self.chain.forward(joints_rad).base_from_tool
    }

    /// Poses of all bodies for given joint angles and the opening between the pads, metres.
    pub fn body_poses(&self, joints_rad: &JointVector, opening_m: f64) -> BodyPoses {
        let poses = self.chain.forward(joints_rad);
        BodyPoses {
            base_from_link: poses.base_from_link,
            base_from_tool: poses.base_from_tool,
            base_from_finger: tool_from_fingers(opening_m)
                .map(|tool_from_finger| poses.base_from_tool * tool_from_finger),
        }
    }
}

fn joint(
    origin_in_parent: Vector3<f64>,
    axis: nalgebra::Unit<Vector3<f64>>,
    limit_rad: f64,
    max_velocity_rad_s: f64,
) -> Joint {
    Joint {
        parent_from_joint: Translation3::from(origin_in_parent).into(),
        axis,
        min_rad: -limit_rad,
        max_rad: limit_rad,
        max_velocity_rad_s,
        max_acceleration_rad_s2: max_velocity_rad_s / 0.4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link_capsules;

    #[test]
    fn at_home_the_hand_is_high_and_points_forward_and_down() {
        let arm = Arm::jaco_like();
        let home = JointVector::from(HOME);
        assert!(arm.chain().check(&home).is_ok() && !arm.is_self_colliding(&home));
        let tool = arm.tool_pose(&home);
        let expected = Vector3::new(0.142, -0.0098, 0.360);
        assert!(
            (tool.translation.vector - expected).norm() < 0.001,
            "{}",
            tool.translation
        );
        let approach = tool.rotation * Vector3::z();
        assert!(approach.x > 0.6 && approach.z < -0.6);
        let closing = tool.rotation * Vector3::x();
        assert!(closing.y.abs() > 0.999);
    }

    #[test]
    fn home_pose_stays_behind_the_front_limit() {
        let arm = Arm::jaco_like();
        let home = JointVector::from(HOME);
        let opening_m = arm.gripper().max_opening_m;
        for capsule in link_capsules(&arm, &home, opening_m) {
            assert!(capsule.from.x.max(capsule.to.x) + capsule.radius_m < 0.2);
        }
        for capsule in &link_capsules(&arm, &home, opening_m)[3..] {
            assert!(capsule.from.z.min(capsule.to.z) - capsule.radius_m > 0.2);
        }
    }

    #[test]
    fn no_tool_position_is_beyond_the_reach() {
        let arm = Arm::jaco_like();
        let shoulder = Vector3::new(0.0, 0.0, arm.dimensions().base_m);
        let stretched = JointVector::from([0.4, 1.3, 0.0, 0.2, 0.0, 0.0]);
        let tool = arm.tool_pose(&stretched).translation.vector;
        let distance = (tool - shoulder).norm();
        assert!(distance <= arm.dimensions().reach_m() && distance > 0.93);
    }
}
