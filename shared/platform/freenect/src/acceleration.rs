//! Accelerometer in the Kinect's foot.

use crate::raw::TiltState;

/// Counts of the accelerometer per g (Kionix KXSD9, `libfreenect.h`).
const COUNTS_PER_G: f64 = 819.0;
/// Standard gravity, m/s².
const G_MPS2: f64 = 9.80665;

/// Measured acceleration (specific force), m/s², in the sensor's own axes.
///
/// At rest it points away from the earth: about (0, +9.81, 0) for a level Kinect, so its y axis
/// points up where that of the camera frame points down. Accurate to a few degrees (Microsoft's
/// Kinect for Windows SDK 1.8 documentation: one degree, and up to three of drift with
/// temperature).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Acceleration {
    /// Acceleration along the sensor's width, m/s².
    pub x_mps2: f64,
    /// Component upwards for a level sensor, m/s².
    pub y_mps2: f64,
    /// Acceleration along the viewing direction, m/s².
    pub z_mps2: f64,
}

impl Acceleration {
    /// Converts counts to m/s². `None` for the all-zero state the library holds before the first
    /// reading: a sensor on the ground never measures zero.
    pub(crate) fn of_tilt_state(state: &TiltState) -> Option<Self> {
        let counts = [
            state.accelerometer_x,
            state.accelerometer_y,
            state.accelerometer_z,
        ];
        let [x_mps2, y_mps2, z_mps2] = counts.map(|count| f64::from(count) / COUNTS_PER_G * G_MPS2);
        (counts != [0; 3]).then_some(Self {
            x_mps2,
            y_mps2,
            z_mps2,
        })
    }
}
