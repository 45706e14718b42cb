//! The simulated table: physics scene, simulated Kinect, arm, hand, ground truth.
