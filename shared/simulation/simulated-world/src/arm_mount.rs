//! Mounting pose of the arm, and its gripper.

use arm_kinematics::GripperModel;
use geometry::RigidTransform;
use nalgebra::{Translation3, UnitQuaternion, Vector3};

/// Mounting pose of the arm's base plate, and the gripper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmMount {
    /// Position of the arm's base, world frame, metres.
    pub position_m: [f64; 3],
    /// Yaw of the forward direction from world x, degrees.
    pub yaw_deg: f64,
    /// Gripper at the end of the arm.
    pub gripper: GripperModel,
}

impl Default for ArmMount {
    /// Near left corner of the default table, facing its middle. The folded arm is out of the
    /// default camera's view.
    fn default() -> Self {
        Self {
            position_m: [-0.44, -0.50, 0.70],
            yaw_deg: 50.0,
            gripper: GripperModel::JACO_LIKE,
        }
    }
}

impl ArmMount {
    /// Pose of the base frame, world frame.
    pub fn world_from_base(&self) -> RigidTransform {
        RigidTransform::from_parts(
            Translation3::from(Vector3::from(self.position_m)),
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.yaw_deg.to_radians()),
        )
    }
}
