//! Motors of the arm: measured joints, and velocities as set points.

use arm_kinematics::{GripperModel, HOME, N_JOINTS};

/// Longest time for which a velocity is held without a new one, seconds: the motors' own watchdog.
pub(crate) const HOLD_TIME_S: f64 = 0.1;

/// Joints and fingers as they are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measured {
    /// Joint angles from the base outwards, radians.
    pub(crate) angles_rad: [f64; N_JOINTS],
    /// Joint velocities, radians per second.
    pub(crate) velocities_rad_s: [f64; N_JOINTS],
    /// Distance between the finger pads, metres.
    pub(crate) opening_m: f64,
}

/// Motors that take velocities, such as those of most arms.
pub(crate) trait Motors {
    /// Measures all joints.
    ///
    /// # Errors
    /// A sentence when the arm does not answer.
    fn measure(&mut self, now_ns: u64) -> Result<Measured, String>;

    /// Sends the velocities of the joints, rad/s, and that of the opening of the fingers, m/s.
    ///
    /// # Errors
    /// A sentence when the arm does not take them.
    fn send(&mut self, velocities_rad_s: [f64; N_JOINTS], opening_m_s: f64) -> Result<(), String>;
}

/// Motors that are not there: velocities are integrated.
#[derive(Debug, Clone)]
pub(crate) struct Integrator {
    now: Measured,
    opening_m_s: f64,
    measured_ns: Option<u64>,
}

impl Integrator {
    /// Motors of an arm that is folded, with open fingers.
    pub(crate) fn at_home() -> Self {
        Self {
            now: Measured {
                angles_rad: HOME,
                velocities_rad_s: [0.0; N_JOINTS],
                opening_m: GripperModel::JACO_LIKE.max_opening_m,
            },
            opening_m_s: 0.0,
            measured_ns: None,
        }
    }
}

impl Motors for Integrator {
    fn measure(&mut self, now_ns: u64) -> Result<Measured, String> {
        let before_ns = self.measured_ns.replace(now_ns).unwrap_or(now_ns);
        let step_s = (1e-9 * now_ns.saturating_sub(before_ns) as f64).min(HOLD_TIME_S);
        let joints = self.now.angles_rad.iter_mut();
        for (angle_rad, velocity_rad_s) in joints.zip(self.now.velocities_rad_s) {
            *angle_rad += step_s * velocity_rad_s;
        }
        let opening_m = self.now.opening_m + step_s * self.opening_m_s;
        // The fingers meet, and end at their rails.
        self.now.opening_m = opening_m.clamp(0.0, GripperModel::JACO_LIKE.max_opening_m);
        Ok(self.now)
    }

    fn send(&mut self, velocities_rad_s: [f64; N_JOINTS], opening_m_s: f64) -> Result<(), String> {
        self.now.velocities_rad_s = velocities_rad_s;
        self.opening_m_s = opening_m_s;
        Ok(())
    }
}
