//! Serial kinematic chain: joint limits, forward kinematics and geometric Jacobian.

use geometry::RigidTransform;
use nalgebra::{SMatrix, SVector, Unit, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

use crate::Error;

/// Number of joints of the arm.
pub const N_JOINTS: usize = 6;

/// One value per joint, from the base to the hand.
pub type JointVector = SVector<f64, N_JOINTS>;

/// Geometric Jacobian, 6 x 6: maps joint velocities, rad/s, to the tool's velocity in the base
/// frame: three rows of linear velocity in m/s, then three of angular velocity in rad/s.
pub type Jacobian = SMatrix<f64, 6, N_JOINTS>;

/// Revolute joint: mounting pose on the parent link, axis and limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// Frame of the child link at angle 0, in the frame of the parent link.
    pub parent_from_joint: RigidTransform,
    /// Axis of positive rotation of the joint, joint frame.
    pub axis: Unit<Vector3<f64>>,
    /// Lower joint limit, radians.
    pub min_rad: f64,
    /// Upper joint limit, radians.
    pub max_rad: f64,
    /// Maximum joint velocity, rad/s, > 0.
    pub max_velocity_rad_s: f64,
    /// Maximum joint acceleration, rad/s², > 0.
    pub max_acceleration_rad_s2: f64,
}

impl Joint {
    /// Pose of the child link in the frame of the parent link.
    pub fn parent_from_link(&self, angle_rad: f64) -> RigidTransform {
        self.parent_from_joint * UnitQuaternion::from_axis_angle(&self.axis, angle_rad)
    }

    /// True if an angle is within the limits; false for NaN.
    pub fn contains(&self, angle_rad: f64) -> bool {
        (self.min_rad..=self.max_rad).contains(&angle_rad)
    }

    /// Equivalent angle (differing by whole turns) within the limits that is nearest to
    /// `near_rad`.
    pub(crate) fn equivalent_near(&self, angle_rad: f64, near_rad: f64) -> Option<f64> {
        let turns = ((near_rad - angle_rad) / TAU).round();
        (-2..=2)
            .map(|extra| angle_rad + TAU * (turns + f64::from(extra)))
            .filter(|&angle| self.contains(angle))
            .min_by(|a, b| (a - near_rad).abs().total_cmp(&(b - near_rad).abs()))
    }
}

/// Serial chain of joints from the base to the tool.
#[derive(Debug, Clone, PartialEq)]
pub struct KinematicChain {
    /// Joints, from the base to the hand.
    pub joints: [Joint; N_JOINTS],
    /// Pose of the tool in the frame of the last link.
    pub last_link_from_tool: RigidTransform,
}

/// Poses of all links for given joint angles (forward kinematics).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkPoses {
    /// Link poses: the base, then the link behind each joint.
    pub base_from_link: [RigidTransform; N_JOINTS + 1],
    /// Pose of the tool in the base frame.
    pub base_from_tool: RigidTransform,
}

impl KinematicChain {
    /// Forward kinematics: poses of all links and of the tool.
    pub fn forward(&self, joints_rad: &JointVector) -> LinkPoses {
        let mut base_from_link = [RigidTransform::identity(); N_JOINTS + 1];
        for (i, joint) in self.joints.iter().enumerate() {
            base_from_link[i + 1] = base_from_link[i] * joint.parent_from_link(joints_rad[i]);
        }
        LinkPoses {
            base_from_tool: base_from_link[N_JOINTS] * self.last_link_from_tool,
            base_from_link,
        }
    }

    /// Geometric Jacobian of the tool's origin, base frame.
    pub fn jacobian(&self, poses: &LinkPoses) -> Jacobian {
        let mut jacobian = Jacobian::zeros();
        let tool = poses.base_from_tool.translation.vector;
        for (i, joint) in self.joints.iter().enumerate() {
            let link = &poses.base_from_link[i + 1];
            let axis = link.rotation * joint.axis.into_inner();
            let lever = tool - link.translation.vector;
            jacobian
                .fixed_view_mut::<3, 1>(0, i)
                .copy_from(&axis.cross(&lever));
            jacobian.fixed_view_mut::<3, 1>(3, i).copy_from(&axis);
        }
        jacobian
    }

    /// Joint angles clamped to the limits; NaN becomes the middle of the joint's range.
    pub fn clamped(&self, joints_rad: &JointVector) -> JointVector {
        JointVector::from_fn(|i, _| {
            let Joint {
                min_rad, max_rad, ..
            } = self.joints[i];
            if joints_rad[i].is_nan() {
                return 0.5 * (min_rad + max_rad);
            }
            joints_rad[i].clamp(min_rad, max_rad)
        })
    }

    /// Validates joint angles against the limits.
    ///
    /// # Errors
    ///
    /// [`Error::BadNumber`] or [`Error::JointLimit`] for the first invalid angle.
    pub fn check(&self, joints_rad: &JointVector) -> Result<(), Error> {
        for (i, joint) in self.joints.iter().enumerate() {
            let angle_rad = joints_rad[i];
            if !angle_rad.is_finite() {
                return Err(Error::BadNumber {
                    what: "a joint angle",
                    rule: "it must be a finite number",
                });
            }
            if !joint.contains(angle_rad) {
                return Err(Error::JointLimit {
                    joint: i + 1,
                    angle_rad,
                    min_rad: joint.min_rad,
                    max_rad: joint.max_rad,
                });
            }
        }
        Ok(())
    }

    /// Travel time norm, seconds: root of the summed squares of each joint's least travel time.
    pub(crate) fn travel_time_norm_s(&self, from: &JointVector, to: &JointVector) -> f64 {
        JointVector::from_fn(|i, _| (to[i] - from[i]) / self.joints[i].max_velocity_rad_s).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Arm, test_joint_angles};
    use nalgebra::Point3;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    fn tool_after(joint: usize, angle_rad: f64) -> RigidTransform {
        let mut joints = JointVector::zeros();
        joints[joint] = angle_rad;
        Arm::jaco_like().tool_pose(&joints)
    }

    #[test]
    fn zero_angles_stretch_the_arm_upwards() {
        let tool = tool_after(0, 0.0);
        let height = 0.2755 + 0.41 + 0.2073 + 0.0743 + 0.0743 + 0.1687;
        assert!((tool.translation.vector - Vector3::new(0.0, -0.0098, height)).norm() < 1e-12);
        assert!(tool.rotation.angle() < 1e-12);
    }

    #[test]
    fn single_joints_move_the_tool_to_known_positions() {
        let check = |joint, expected: [f64; 3]| {
            let tool = tool_after(joint, FRAC_PI_2).translation.vector;
            assert!(
                (tool - Vector3::from(expected)).norm() < 1e-12,
                "joint {joint}: {tool}"
            );
        };
        let (shoulder, elbow, wrist) = (0.2755, 0.6855, 0.6855 + 0.2816);
        check(0, [0.0098, 0.0, wrist + 0.243]);
        check(1, [0.41 + 0.2816 + 0.243, -0.0098, shoulder]);
        check(2, [0.2816 + 0.243, -0.0098, elbow]);
        check(3, [0.0, -0.0098, wrist + 0.243]);
        check(4, [0.243, -0.0098, wrist]);
        check(5, [0.0, -0.0098, wrist + 0.243]);
    }

    #[test]
    fn the_wrists_axes_meet_in_one_point() {
        let arm = Arm::jaco_like();
        let joints = JointVector::from([0.3, 0.5, 1.0, 0.7, 1.1, -0.4]);
        let poses = arm.chain().forward(&joints);
        let meeting = poses.base_from_link[5] * Point3::origin();
        for (joint, link) in [(3, 4), (4, 5), (5, 6)] {
            let pose = &poses.base_from_link[link];
            let axis = pose.rotation * arm.chain().joints[joint].axis.into_inner();
            let beside = axis.cross(&(meeting.coords - pose.translation.vector));
            assert!(beside.norm() < 1e-12);
        }
    }

    proptest! {
        #[test]
        fn the_jacobian_is_the_derivative_of_the_tools_pose(joints in test_joint_angles()) {
            let arm = Arm::jaco_like();
            let jacobian = arm.chain().jacobian(&arm.chain().forward(&joints));
            let h = 1e-6;
            for i in 0..N_JOINTS {
                let at = |offset: f64| {
                    let mut moved = joints;
                    moved[i] += offset;
                    arm.tool_pose(&moved)
                };
                let (before, after) = (at(-h), at(h));
                let shift = (after.translation.vector - before.translation.vector) / (2.0 * h);
                let turn = (after.rotation * before.rotation.inverse()).scaled_axis() / (2.0 * h);
                for row in 0..3 {
                    prop_assert!((jacobian[(row, i)] - shift[row]).abs() < 1e-7);
                    prop_assert!((jacobian[(row + 3, i)] - turn[row]).abs() < 1e-7);
                }
            }
        }

        #[test]
        fn whole_turns_lead_to_the_nearest_equal_angle(
            angle in -20.0..20.0_f64,
            near in -TAU..TAU,
        ) {
            let joint = Arm::jaco_like().chain().joints[0];
            let found = joint.equivalent_near(angle.rem_euclid(TAU), near).unwrap();
            let turns = (found - angle) / TAU;
            prop_assert!((turns - turns.round()).abs() < 1e-9 && joint.contains(found));
            for other in [found - TAU, found + TAU] {
                let is_nearer = (other - near).abs() < (found - near).abs() - 1e-12;
                prop_assert!(!(joint.contains(other) && is_nearer));
            }
        }
    }

    #[test]
    fn invalid_angles_are_rejected_and_clamped() {
        let chain = Arm::jaco_like().chain().clone();
        let mut joints = JointVector::zeros();
        joints[1] = 2.5;
        assert!(matches!(
            chain.check(&joints),
            Err(Error::JointLimit { joint: 2, .. })
        ));
        joints[4] = f64::NAN;
        assert!(chain.check(&chain.clamped(&joints)).is_ok());
        joints[1] = 0.0;
        assert!(matches!(chain.check(&joints), Err(Error::BadNumber { .. })));
    }
}
