//! Link lengths of the arm.

/// Link lengths along the stretched arm, metres, named as in the data sheet of the Kinova JACO.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmDimensions {
    /// Height of the shoulder above the mounting plate, `D1`, metres.
    pub base_m: f64,
    /// Length of the upper arm from shoulder to elbow, `D2`, metres.
    pub upper_arm_m: f64,
    /// Length of the forearm from elbow to the first wrist joint, `D3`, metres.
    pub forearm_m: f64,
    /// Distance from the first to the second wrist joint, `D4`, metres.
    pub first_wrist_m: f64,
    /// Distance from the second to the third wrist joint, `D5`, metres.
    pub second_wrist_m: f64,
    /// Third wrist joint to the middle of the finger pads, `D6`.
    pub hand_m: f64,
    /// Lateral offset of the forearm at the elbow, `e2`.
    pub elbow_offset_m: f64,
}

impl ArmDimensions {
    /// Lengths of the six-joint JACO; the reach from the shoulder is 0.93 m.
    pub const JACO_LIKE: Self = Self {
        base_m: 0.2755,
        upper_arm_m: 0.4100,
        forearm_m: 0.2073,
        first_wrist_m: 0.0743,
        second_wrist_m: 0.0743,
        hand_m: 0.1687,
        elbow_offset_m: 0.0098,
    };

    /// Height of the first joint above the mounting plate, metres.
    pub(crate) fn base_joint_height_m(&self) -> f64 {
        0.56 * self.base_m
    }

    /// Distance from the elbow to the wrist centre, metres.
    pub(crate) fn elbow_to_wrist_m(&self) -> f64 {
        self.forearm_m + self.first_wrist_m
    }

    /// Distance from the wrist centre to the tool, metres.
    pub(crate) fn wrist_to_tool_m(&self) -> f64 {
        self.second_wrist_m + self.hand_m
    }

    /// Greatest distance of the tool from the shoulder, metres.
    pub fn reach_m(&self) -> f64 {
        (self.upper_arm_m + self.elbow_to_wrist_m()).hypot(self.elbow_offset_m)
            + self.wrist_to_tool_m()
    }
}
