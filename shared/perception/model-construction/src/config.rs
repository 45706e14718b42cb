//! Configuration of model construction.

use sensor_noise::DepthNoise;

/// Configuration of model construction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    /// Side length of the voxels, metres. Chosen: 2 mm, of the order of a Kinect's noise.
    pub voxel_m: f32,
    /// Share of the view's surface that must lie within 4 mm of the model, 0 to 1.
    pub common_share_min: f64,
    /// Contradiction of model and view from which a view is refused, 0 to 2.
    pub contradiction_max: f64,
    /// Distance from the expected pose from which a view is refused, in standard deviations.
    pub off_sigmas_max: f64,
    /// Angle between viewing directions below which a view is registered only, and not fused,
    /// radians.
    pub step_min_rad: f64,
    /// Angle by which the object is turned between two placements, counter-clockwise as seen from
    /// above, radians; `None` when it is not known.
    pub turn_rad: Option<f64>,
    /// Noise of the depth of the camera.
    pub depth_noise: DepthNoise,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            voxel_m: 0.002,
            common_share_min: 0.35,
            contradiction_max: 1.0,
            off_sigmas_max: 4.0,
            step_min_rad: 0.0,
            turn_rad: None,
            depth_noise: DepthNoise::KINECT_V1,
        }
    }
}
