//! Where an object is, how fast it moves, how it is turned and how large it is.

use crate::Error;
use crate::error::check_settings;
use detection::kinect_depth_sigma_m;
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Farthest coordinate of an object, metres.
const COORDINATE_MAX_M: f64 = 1e5;

/// Longest half side of an object, metres.
const HALF_SIDE_MAX_M: f64 = 50.0;

/// Nothing on a table is faster, metres a second.
const SPEED_MAX_M_S: f64 = 5.0;

/// An object that is not seen is not thought to move on for longer than this,
/// seconds.
const COAST_MAX_S: f64 = 1.0;

/// The uncertainty does not grow for longer than this, seconds.
const GROWTH_MAX_S: f64 = 10.0;

/// A box cut by the border of the image has its centre somewhere else: this
/// share of its longest side is added to the noise of the position.
const CUT_SHARE: f64 = 0.25;

/// Sides may differ by this factor before a quarter turn explains them better
/// than a turn by 45 degrees.
const SIDE_RATIO_TURN: f64 = 1.65;

/// What is expected of objects and of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionConfig {
    /// Standard deviation of the acceleration, m/s²; 0.01 to 100.
    pub acceleration_sigma_m_s2: f64,
    /// Least standard deviation of a measured box centre, metres; 0.0001 to
    /// 0.1. Where the depth noise of the sensor is more, it counts. The default
    /// covers what a handle seen in one frame and not in the next moves a box.
    pub position_sigma_min_m: f64,
    /// Time in which a changed orientation is followed to 63 %, seconds;
    /// 0.001 to 10.
    pub turning_time_s: f64,
    /// Time in which a changed size is followed to 63 %, seconds; 0.001 to 100.
    pub resizing_time_s: f64,
}

impl Default for MotionConfig {
    fn default() -> Self {
        Self {
            acceleration_sigma_m_s2: 1.5,
            position_sigma_min_m: 0.008,
            turning_time_s: 0.15,
            resizing_time_s: 0.6,
        }
    }
}

impl MotionConfig {
    /// Checks the settings.
    ///
    /// # Errors
    /// Names the first setting outside its range.
    pub fn validated(self) -> Result<Self, Error> {
        check_settings(&[
            (
                "acceleration_sigma_m_s2",
                self.acceleration_sigma_m_s2,
                0.01,
                100.0,
            ),
            ("position_sigma_min_m", self.position_sigma_min_m, 1e-4, 0.1),
            ("turning_time_s", self.turning_time_s, 1e-3, 10.0),
            ("resizing_time_s", self.resizing_time_s, 1e-3, 100.0),
        ])?;
        Ok(self)
    }
}

/// What one frame says of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    stamp_ns: u64,
    box_in_world: OrientedBox,
    depth_m: f64,
    is_cut: bool,
}

impl Measurement {
    /// A box measured at a distance of `depth_m` along the camera's axis.
    /// `is_cut` says that the border of the image cuts it.
    ///
    /// # Errors
    /// When a number is not finite, a coordinate is beyond 100 km, a half side
    /// is negative or beyond 50 m, or the rotation is none.
    pub fn new(
        stamp_ns: u64,
        box_in_world: OrientedBox,
        depth_m: f64,
        is_cut: bool,
    ) -> Result<Self, Error> {
        let wrong = |rule| Err(Error::ImpossibleMeasurement { rule });
        let near = |value: &f64| value.abs() <= COORDINATE_MAX_M;
        if !box_in_world.centre().iter().all(near) {
            return wrong("its centre must lie within 100 km");
        }
        if !box_in_world
            .half_sides_m
            .iter()
            .all(|side| (0.0..=HALF_SIDE_MAX_M).contains(side))
        {
            return wrong("its half sides must lie between 0 and 50 m");
        }
        let norm = box_in_world.frame_from_box.rotation.norm();
        if !(0.999..=1.001).contains(&norm) {
            return wrong("its orientation must be a unit quaternion");
        }
        if !depth_m.is_finite() {
            return wrong("its depth must be a number");
        }
        Ok(Self {
            stamp_ns,
            box_in_world,
            depth_m,
            is_cut,
        })
    }

    /// Variance of the position, each axis, square metres.
    pub fn position_variance_m2(&self, config: &MotionConfig) -> f64 {
        let sensor_m = kinect_depth_sigma_m(self.depth_m).max(config.position_sigma_min_m);
        let cut_m = if self.is_cut {
            CUT_SHARE * self.box_in_world.sides_m().max()
        } else {
            0.0
        };
        sensor_m * sensor_m + cut_m * cut_m
    }
}

/// The state of one object, world frame.
///
/// A Kalman filter (Kalman 1960) with constant velocity and white acceleration
/// for the centre of the box; since the noise is the same along all axes, the
/// three share one covariance of position and velocity. Orientation and size
/// follow their measurements with fixed time constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionFilter {
    stamp_ns: u64,
    position: Point3<f64>,
    velocity_m_s: Vector3<f64>,
    covariance: Covariance,
    rotation: UnitQuaternion<f64>,
    half_sides_m: Vector3<f64>,
    has_whole_size: bool,
}

/// Covariance of position and velocity of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Covariance {
    position_m2: f64,
    mixed_m2_s: f64,
    velocity_m2_s2: f64,
}

impl Covariance {
    /// After `dt_s` of constant velocity and white acceleration (Bar-Shalom,
    /// Li and Kirubarajan 2001, eq. 6.3.2-4).
    fn grown(&self, dt_s: f64, acceleration_sigma_m_s2: f64) -> Self {
        let jerk = acceleration_sigma_m_s2 * dt_s;
        Self {
            position_m2: self.position_m2
                + dt_s * (2.0 * self.mixed_m2_s + dt_s * self.velocity_m2_s2)
                + 0.25 * (jerk * dt_s).powi(2),
            mixed_m2_s: self.mixed_m2_s + dt_s * self.velocity_m2_s2 + 0.5 * jerk * jerk * dt_s,
            velocity_m2_s2: (self.velocity_m2_s2 + jerk * jerk).min(SPEED_MAX_M_S * SPEED_MAX_M_S),
        }
        .settled()
    }

    /// After a measurement of the position.
    fn measured(&self, variance_m2: f64) -> Self {
        let sum_m2 = self.position_m2 + variance_m2;
        let left = variance_m2 / sum_m2;
        Self {
            position_m2: left * self.position_m2,
            mixed_m2_s: left * self.mixed_m2_s,
            velocity_m2_s2: self.velocity_m2_s2 - self.mixed_m2_s * self.mixed_m2_s / sum_m2,
        }
        .settled()
    }

    /// Kept positive semi-definite against rounding and the limit of speed.
    fn settled(self) -> Self {
        let velocity_m2_s2 = self.velocity_m2_s2.max(0.0);
        let limit = (self.position_m2 * velocity_m2_s2).sqrt();
        Self {
            velocity_m2_s2,
            mixed_m2_s: self.mixed_m2_s.clamp(-limit, limit),
            ..self
        }
    }
}

impl MotionFilter {
    /// A track's first state: at rest, as far as is known.
    pub fn start(measurement: &Measurement, config: &MotionConfig) -> Self {
        // Not seen before, it may have any speed a hand gives it.
        let speed_sigma_m_s = 0.5 * config.acceleration_sigma_m_s2;
        Self {
            stamp_ns: measurement.stamp_ns,
            position: measurement.box_in_world.centre(),
            velocity_m_s: Vector3::zeros(),
            covariance: Covariance {
                position_m2: measurement.position_variance_m2(config),
                mixed_m2_s: 0.0,
                velocity_m2_s2: speed_sigma_m_s.min(SPEED_MAX_M_S).powi(2),
            },
            rotation: measurement.box_in_world.frame_from_box.rotation,
            half_sides_m: measurement.box_in_world.half_sides_m,
            has_whole_size: !measurement.is_cut,
        }
    }

    /// The state expected at a later time; at an earlier one, the state as it is.
    #[must_use]
    pub fn predicted(&self, stamp_ns: u64, config: &MotionConfig) -> Self {
        let dt_s = stamp_ns.saturating_sub(self.stamp_ns) as f64 * 1e-9;
        Self {
            stamp_ns: stamp_ns.max(self.stamp_ns),
            position: self.position + self.velocity_m_s * dt_s.min(COAST_MAX_S),
            covariance: self
                .covariance
                .grown(dt_s.min(GROWTH_MAX_S), config.acceleration_sigma_m_s2),
            ..*self
        }
    }

    /// The state after a measurement.
    ///
    /// # Errors
    /// When the measurement is older than the state.
    pub fn updated(&self, measurement: &Measurement, config: &MotionConfig) -> Result<Self, Error> {
        if measurement.stamp_ns < self.stamp_ns {
            let (stamp_ns, state_stamp_ns) = (measurement.stamp_ns, self.stamp_ns);
            return Err(Error::OutOfOrder {
                stamp_ns,
                state_stamp_ns,
            });
        }
        let dt_s = (measurement.stamp_ns - self.stamp_ns) as f64 * 1e-9;
        let mut state = self.predicted(measurement.stamp_ns, config);
        state.take_position(measurement, config);
        state.take_shape(measurement, dt_s, config);
        Ok(state)
    }

    fn take_position(&mut self, measurement: &Measurement, config: &MotionConfig) {
        let variance_m2 = measurement.position_variance_m2(config);
        let innovation = measurement.box_in_world.centre() - self.position;
        let sum_m2 = self.covariance.position_m2 + variance_m2;
        self.position += innovation * (self.covariance.position_m2 / sum_m2);
        self.velocity_m_s += innovation * (self.covariance.mixed_m2_s / sum_m2);
        self.velocity_m_s = self.velocity_m_s.cap_magnitude(SPEED_MAX_M_S);
        self.covariance = self.covariance.measured(variance_m2);
    }

    fn take_shape(&mut self, measurement: &Measurement, dt_s: f64, config: &MotionConfig) {
        let share = |time_s: f64| 1.0 - (-dt_s / time_s).exp();
        let (rotation, half_sides_m) = self.nearest_reading(&measurement.box_in_world);
        if !self.has_whole_size && !measurement.is_cut {
            self.has_whole_size = true;
            self.half_sides_m = half_sides_m;
        } else if !measurement.is_cut {
            self.half_sides_m += (half_sides_m - self.half_sides_m) * share(config.resizing_time_s);
        }
        let turn = self
            .rotation
            .rotation_to(&rotation)
            .powf(share(config.turning_time_s));
        self.rotation = UnitQuaternion::new_normalize((turn * self.rotation).into_inner());
    }

    /// A box reads the same after a half turn about its upright axis, and with
    /// its sides exchanged after a quarter turn: the reading nearest to this
    /// state, so that the pose does not flip.
    fn nearest_reading(&self, measured: &OrientedBox) -> (UnitQuaternion<f64>, Vector3<f64>) {
        let mut best = (
            f64::INFINITY,
            measured.frame_from_box.rotation,
            measured.half_sides_m,
        );
        for quarter in 0..4 {
            let turn = FRAC_PI_2 * f64::from(quarter);
            let turned = measured.frame_from_box.rotation
                * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
            let sides = measured.half_sides_m;
            let sides = if quarter % 2 == 1 {
                Vector3::new(sides.y, sides.x, sides.z)
            } else {
                sides
            };
            let cost = self.rotation.angle_to(&turned) / FRAC_PI_4 + self.side_mismatch(&sides);
            if cost < best.0 {
                best = (cost, turned, sides);
            }
        }
        (best.1, best.2)
    }

    /// How badly the horizontal sides fit; 1 for a factor of [`SIDE_RATIO_TURN`].
    fn side_mismatch(&self, half_sides_m: &Vector3<f64>) -> f64 {
        let ratio = |i: usize| {
            ((half_sides_m[i] + 1e-3) / (self.half_sides_m[i] + 1e-3))
                .ln()
                .abs()
        };
        (ratio(0) + ratio(1)) / SIDE_RATIO_TURN.ln()
    }

    /// Capture stamp of the state.
    pub fn stamp_ns(&self) -> u64 {
        self.stamp_ns
    }

    /// Velocity, world frame, metres a second.
    pub fn velocity_m_s(&self) -> Vector3<f64> {
        self.velocity_m_s
    }

    /// Variance of the position, each axis, square metres.
    pub fn position_variance_m2(&self) -> f64 {
        self.covariance.position_m2
    }

    /// The box, world frame; its centre and axes are the object's pose.
    pub fn box_in_world(&self) -> OrientedBox {
        let translation = Translation3::from(self.position.coords);
        OrientedBox {
            frame_from_box: RigidTransform::from_parts(translation, self.rotation),
            half_sides_m: self.half_sides_m,
        }
    }
}

#[cfg(test)]
mod tests;
