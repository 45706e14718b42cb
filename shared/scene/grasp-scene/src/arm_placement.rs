//! Placement of the arm's base by its joint angles and the pose of its gripper.

use arm_kinematics::{Arm, JointVector};
use geometry::RigidTransform;
use grasping::PlacedArm;
use scene_client::PlanningFrame;

/// Arm in the frame of planning. Its base follows from where its gripper is and how its joints
/// stand, which every arm reports.
pub fn placed_arm(
    arm: Arm,
    joints_rad: JointVector,
    world_from_gripper: &RigidTransform,
    frame: &PlanningFrame,
) -> PlacedArm {
    let world_from_base = world_from_gripper * arm.tool_pose(&joints_rad).inverse();
    PlacedArm {
        plan_from_base: frame.world_from_plan.inverse() * world_from_base,
        arm,
        joints_rad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arm_kinematics::HOME;
    use nalgebra::{UnitQuaternion, Vector3};

    #[test]
    fn base_is_where_the_gripper_and_the_joints_say() {
        let arm = Arm::jaco_like();
        let joints_rad = JointVector::from(HOME);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.7);
        let world_from_base = RigidTransform::from_parts([0.3, -0.5, 0.7].into(), turn);
        let world_from_gripper = world_from_base * arm.tool_pose(&joints_rad);
        let frame = PlanningFrame {
            world_from_plan: RigidTransform::translation(0.1, 0.2, 0.3),
            plan_from_camera: RigidTransform::identity(),
            table_in_plan: None,
            notes: Vec::new(),
        };
        let placed = placed_arm(arm, joints_rad, &world_from_gripper, &frame);
        let expected = Vector3::new(0.2, -0.7, 0.4);
        assert!((placed.plan_from_base.translation.vector - expected).norm() < 1e-12);
        assert!(placed.plan_from_base.rotation.angle_to(&turn) < 1e-12);
    }
}
