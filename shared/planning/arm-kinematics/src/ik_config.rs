//! Configuration of inverse kinematics.

/// Tolerances and iteration limit of inverse kinematics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IkConfig {
    /// Position tolerance of a solution, metres.
    pub tolerance_m: f64,
    /// Rotation tolerance of a solution, radians.
    pub tolerance_rad: f64,
    /// Iteration limit of one least squares search; there are at most nine searches.
    pub max_iterations: usize,
}

impl Default for IkConfig {
    fn default() -> Self {
        Self {
            tolerance_m: 0.001,
            tolerance_rad: 0.5_f64.to_radians(),
            max_iterations: 60,
        }
    }
}
