//! The axes along which an object is described.

use crate::measurement::Measurement;
use crate::orientation::nearest_reading;
use geometry::OrientedBox;
use nalgebra::UnitQuaternion;

/// Time in which a changed box is followed to 63 %, seconds.
const FOLLOWING_TIME_S: f64 = 0.15;

/// The axes of an object's measured boxes, evened out over a few frames.
///
/// How a box fits a shape depends on the shape alone, so that every track of an
/// object is described along about the same axes, whatever was seen of it before;
/// the tracked orientation begins with the noise of its first frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DescribedAxes {
    stamp_ns: u64,
    shape: OrientedBox,
}

impl DescribedAxes {
    /// Those of an object's first view.
    pub fn start(measurement: &Measurement) -> Self {
        Self {
            stamp_ns: measurement.stamp_ns(),
            shape: *measurement.box_in_world(),
        }
    }

    /// Those after a later view.
    #[must_use]
    pub fn updated(&self, measurement: &Measurement) -> Self {
        let dt_s = measurement.stamp_ns().saturating_sub(self.stamp_ns) as f64 * 1e-9;
        let share = 1.0 - (-dt_s / FOLLOWING_TIME_S).exp();
        let mut shape = nearest_reading(measurement.box_in_world(), &self.shape);
        let old = &self.shape;
        let turn = old
            .frame_from_box
            .rotation
            .rotation_to(&shape.frame_from_box.rotation);
        let rotation = turn.powf(share) * old.frame_from_box.rotation;
        shape.frame_from_box.rotation = UnitQuaternion::new_normalize(rotation.into_inner());
        shape.half_sides_m = old.half_sides_m.lerp(&shape.half_sides_m, share);
        Self {
            stamp_ns: measurement.stamp_ns().max(self.stamp_ns),
            shape,
        }
    }

    /// The box of the last view with these axes, world frame.
    pub fn box_in_world(&self) -> &OrientedBox {
        &self.shape
    }
}
