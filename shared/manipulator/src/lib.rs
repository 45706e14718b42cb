//! The arm: kinematic chain, inverse kinematics, joint motion, gripper.
