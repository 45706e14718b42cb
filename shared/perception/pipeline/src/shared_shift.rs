//! Shared shift of the objects in a frame: an estimate of the error of the camera pose.
//!
//! Objects at rest that shift together have not moved: the camera pose is wrong. The part of
//! the innovation that all of them share is therefore noise of this frame's pose
//! (innovation-based noise estimation, Mehra 1970), and a track that knows it stays at rest.

use nalgebra::Vector3;

/// Number of objects below which a shift is not shared: one object may have moved.
const N_OBJECTS_MIN: usize = 2;

/// Shared shift that the noise of the boxes explains, metres: the depth noise of a Kinect at
/// 1.3 m (Nguyen, Izadi and Lovell 2012).
const SHIFT_NOISE_M: f64 = 0.003;

/// Number of successive frames with the same error of the camera pose: about a second. Their
/// errors are correlated, so the standard deviation of each is inflated by the square root of
/// this number. An estimate.
const N_CORRELATED_FRAMES: f64 = 30.0;

/// Shifts of the objects of a frame along the world axes, metres.
#[derive(Debug, Clone, Default)]
pub(crate) struct SharedShift {
    shifts_m: [Vec<f64>; 3],
}

impl SharedShift {
    /// Removes the shifts of the last frame.
    pub(crate) fn clear(&mut self) {
        for along in &mut self.shifts_m {
            along.clear();
        }
    }

    /// Adds the shift of an object from where it was expected.
    pub(crate) fn add(&mut self, shift_m: &Vector3<f64>) {
        for (along, value) in self.shifts_m.iter_mut().zip(shift_m.iter()) {
            along.push(*value);
        }
    }

    /// Shift that the objects share along the world axes, metres; 0 for fewer than two objects,
    /// and where the noise of the boxes explains it.
    pub(crate) fn shift_m(&mut self) -> Vector3<f64> {
        let [x, y, z] = self.shifts_m.each_mut().map(|along| shared(along));
        let shift_m = Vector3::new(x, y, z);
        if shift_m.norm() > SHIFT_NOISE_M {
            shift_m
        } else {
            Vector3::zeros()
        }
    }
}

/// Standard deviation of the camera's position in a frame with a shared shift, metres, for a
/// filter that takes successive frames as independent.
pub(crate) fn pose_sigma_m(shift_m: &Vector3<f64>) -> f64 {
    (shift_m.norm() - SHIFT_NOISE_M).max(0.0) * N_CORRELATED_FRAMES.sqrt()
}

/// Shared part of several values: their median, of an even number the middle value nearer to
/// 0, and 0 if the two middle values have different signs.
fn shared(values: &mut [f64]) -> f64 {
    if values.len() < N_OBJECTS_MIN {
        return 0.0;
    }
    values.sort_unstable_by(f64::total_cmp);
    let [low, high] = [values[(values.len() - 1) / 2], values[values.len() / 2]];
    if low * high <= 0.0 {
        0.0
    } else if low.abs() < high.abs() {
        low
    } else {
        high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length_m(shifts_m: &[[f64; 3]]) -> f64 {
        let mut shift = SharedShift::default();
        shift.add(&Vector3::repeat(9.0));
        shift.clear();
        for shift_m in shifts_m {
            shift.add(&Vector3::from(*shift_m));
        }
        shift.shift_m().norm()
    }

    #[test]
    fn shared_shift_is_what_all_objects_have_in_common() {
        let still = [0.0, 0.004, -0.004];
        assert_eq!(length_m(&[]), 0.0);
        assert_eq!(
            length_m(&[[0.1, 0.1, 0.1]]),
            0.0,
            "one object may have moved"
        );
        assert_eq!(length_m(&[[0.1, 0.0, 0.0], still]), 0.0);
        assert_eq!(
            length_m(&[[0.1, 0.0, 0.0], still, still]),
            0.004_f64.hypot(0.004)
        );
        assert_eq!(length_m(&[[0.04, 0.0, 0.0], [0.03, 0.0, 0.0]]), 0.03);
        assert_eq!(length_m(&[[-0.04, 0.0, 0.0], [0.03, 0.0, 0.0]]), 0.0);
        let all = [[0.05, 0.0, 0.03], [0.04, 0.0, 0.03], [0.03, 0.0, 0.03]];
        assert!((length_m(&all) - 0.05).abs() < 1e-12);
        assert!((length_m(&[[0.002; 3]; 2]) - 0.002 * 3_f64.sqrt()).abs() < 1e-12);
        assert_eq!(length_m(&[[0.001; 3]; 2]), 0.0, "noise of the boxes");
    }
}
