//! Where an object is, how fast it moves, how it is turned and how large it is.

use crate::Error;
use crate::axis_filter::{End, SlideCovariance, TurnCovariance};
use crate::error::check_settings;
use crate::evidence::Evidence;
use crate::faces::{self, Trust, UPRIGHT};
use crate::measurement::{HALF_SIDE_MAX_M, Measurement};
use crate::orientation::{nearest_reading, turn_sigmas_rad};
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Nothing on a table is faster, metres a second.
const SPEED_MAX_M_S: f64 = 5.0;

/// Nothing on a table turns faster, radians a second.
const TURN_SPEED_MAX_RAD_S: f64 = 12.0;

/// An object that is not seen is not thought to move on for longer than this,
/// seconds.
const COAST_MAX_S: f64 = 0.3;

/// The uncertainty does not grow for longer than this, seconds.
const GROWTH_MAX_S: f64 = 10.0;

/// What turns goes on turning for about this long, seconds.
const TURN_DAMPING_S: f64 = 0.3;

/// What is hidden is not thought to go on moving for longer than about this,
/// seconds.
const UNSEEN_DAMPING_S: f64 = 0.15;

/// However it is turned when it is seen first is how it is turned, for what is round:
/// standard deviation of the first orientation at most, radians (3 degrees), and of
/// its first speed, radians a second.
const FIRST_TURN_SIGMA_RAD: f64 = 0.05;
const FIRST_TURN_SPEED_RAD_S: f64 = 0.05;

/// With more noise of its turn than this, radians (8 degrees, of sides like 5 and 3),
/// an object counts as round.
const CLEAR_SIGMA_RAD: f64 = 0.14;

/// So may one whose shorter side on the ground has this share of the longer one.
const SQUARE_RATIO: f64 = 0.85;

/// With less than this, radians (6 degrees), it is known how it is turned.
const KNOWN_SIGMA_RAD: f64 = 0.105;

/// What nothing touches is turned by this share of what a hand may do.
const RESTING_TURN_SHARE: f64 = 0.02;

/// Thinnest box, half of a side, metres.
const HALF_SIDE_MIN_M: f64 = 1e-3;

/// Noise of a face that contradicts what was seen before, metres.
const DOUBT_SIGMA_M: f64 = 0.010;

/// A half side of which a part may be missing is uncertain by this share.
const CUT_SHARE: f64 = 0.25;

/// A box smaller than the expected one by this factor is that of a part.
const PART_VOLUME_SHARE: f64 = 0.8;

/// Where a side face is not sure, the footprint says less of the turn by this factor.
const PART_TURN_FACTOR: f64 = 3.0;

/// A surprise of more sigma than this is a hand's doing (99.7 %) ...
const MANOEUVRE_SIGMAS: f64 = 3.0;

/// ... and one of more than this, with a hand's noise, no motion but a new place.
const JUMP_SIGMAS: f64 = 6.0;

/// What is expected of objects and of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionConfig {
    /// Standard deviation of the acceleration of what a hand moves, m/s²; 0.01 to
    /// 100.
    pub acceleration_sigma_m_s2: f64,
    /// Standard deviation of the acceleration of what nothing touches, m/s²; 0.001
    /// to 100. A surprise too large for it is taken for a hand's doing.
    pub resting_acceleration_sigma_m_s2: f64,
    /// Standard deviation of the angular acceleration of what a hand turns,
    /// rad/s²; 0.01 to 1000. What nothing touches has a fiftieth of it.
    pub turn_acceleration_sigma_rad_s2: f64,
    /// How far a half side walks at random in a second, metres; 0.00001 to 0.1.
    pub resizing_sigma_m: f64,
    /// Least standard deviation of a face of a measured box, metres; 0.0001 to 0.1.
    pub face_sigma_min_m: f64,
    /// Least standard deviation of a measured box centre where objects are told
    /// apart, metres; 0.0001 to 0.1. The default covers what a handle seen in one
    /// frame and not in the next moves a box.
    pub position_sigma_min_m: f64,
}

impl Default for MotionConfig {
    fn default() -> Self {
        Self {
            acceleration_sigma_m_s2: 1.5,
            resting_acceleration_sigma_m_s2: 0.1,
            turn_acceleration_sigma_rad_s2: 15.0,
            resizing_sigma_m: 0.002,
            face_sigma_min_m: 0.002,
            position_sigma_min_m: 0.008,
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
            (
                "resting_acceleration_sigma_m_s2",
                self.resting_acceleration_sigma_m_s2,
                1e-3,
                100.0,
            ),
            (
                "turn_acceleration_sigma_rad_s2",
                self.turn_acceleration_sigma_rad_s2,
                0.01,
                1000.0,
            ),
            ("resizing_sigma_m", self.resizing_sigma_m, 1e-5, 0.1),
            ("face_sigma_min_m", self.face_sigma_min_m, 1e-4, 0.1),
            ("position_sigma_min_m", self.position_sigma_min_m, 1e-4, 0.1),
        ])?;
        Ok(self)
    }
}

/// Whether a hand may be at work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Motion {
    Resting,
    Handled,
}

/// The state of one object, world frame.
///
/// A Kalman filter (Kalman 1960) on the position, velocity, orientation, angular
/// velocity and half sides of its box. Each face of a measured box is a measurement
/// of centre and side together, and left out where something hides the object
/// there, so that what is half hidden neither moves nor shrinks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionFilter {
    stamp_ns: u64,
    position: Point3<f64>,
    velocity_m_s: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
    /// Along the axes of the box.
    turn_speed_rad_s: Vector3<f64>,
    half_sides_m: Vector3<f64>,
    slides: [SlideCovariance; 3],
    turns: [TurnCovariance; 3],
    completeness: f64,
}

impl MotionFilter {
    /// A track's first state: at rest, as far as is known.
    pub fn start(measurement: &Measurement, config: &MotionConfig) -> Self {
        let shape = measurement.box_in_world();
        let rotation = shape.frame_from_box.rotation;
        let sigmas_m = measurement.face_sigmas_m(&axes(&rotation), config);
        let speed_m_s = first_speed_m_s(config);
        let missing_m = if measurement.seen().is_cut {
            CUT_SHARE * shape.half_sides_m.max()
        } else {
            0.0
        };
        let slide = |axis: usize| {
            let variance_m2 = sigmas_m[axis].powi(2) + missing_m * missing_m;
            SlideCovariance::of(variance_m2, speed_m_s * speed_m_s, variance_m2)
        };
        let turns = turn_sigmas_rad(&measurement.seen().variances_m2);
        Self {
            stamp_ns: measurement.stamp_ns(),
            position: shape.centre(),
            velocity_m_s: Vector3::zeros(),
            rotation,
            turn_speed_rad_s: Vector3::zeros(),
            half_sides_m: shape.half_sides_m.map(|half| half.max(HALF_SIDE_MIN_M)),
            slides: std::array::from_fn(slide),
            turns: std::array::from_fn(|axis| {
                // But the box of a part is turned anyhow.
                let turn_rad = if measurement.seen().is_cut {
                    turns[axis]
                } else {
                    turns[axis].min(FIRST_TURN_SIGMA_RAD)
                };
                TurnCovariance::of(turn_rad.powi(2), FIRST_TURN_SPEED_RAD_S.powi(2))
            }),
            completeness: 1.0,
        }
    }

    /// The state expected at a later time, when a hand may move the object; at an
    /// earlier one, the state as it is.
    #[must_use]
    pub fn predicted(&self, stamp_ns: u64, config: &MotionConfig) -> Self {
        self.moved_on(stamp_ns, Motion::Handled, config)
    }

    fn moved_on(&self, stamp_ns: u64, motion: Motion, config: &MotionConfig) -> Self {
        let dt_s = stamp_ns.saturating_sub(self.stamp_ns) as f64 * 1e-9;
        let (slide_m_s2, turn_share) = match motion {
            Motion::Handled => (config.acceleration_sigma_m_s2, 1.0),
            Motion::Resting => (config.resting_acceleration_sigma_m_s2, RESTING_TURN_SHARE),
        };
        let turn_rad_s2 = config.turn_acceleration_sigma_rad_s2 * turn_share;
        let (growth_s, coast_s) = (dt_s.min(GROWTH_MAX_S), dt_s.min(COAST_MAX_S));
        let resizing_m2_s = config.resizing_sigma_m * config.resizing_sigma_m;
        let turn = UnitQuaternion::from_scaled_axis(self.turn_speed_rad_s * coast_s);
        Self {
            stamp_ns: stamp_ns.max(self.stamp_ns),
            position: self.position + self.velocity_m_s * coast_s,
            rotation: UnitQuaternion::new_normalize((self.rotation * turn).into_inner()),
            turn_speed_rad_s: self.turn_speed_rad_s * (-dt_s / TURN_DAMPING_S).exp(),
            slides: self.slides.map(|slide| {
                slide
                    .grown(growth_s, slide_m_s2, resizing_m2_s)
                    .settled(SPEED_MAX_M_S)
            }),
            turns: self.turns.map(|turn| {
                turn.grown(growth_s, turn_rad_s2, TURN_DAMPING_S)
                    .settled(PI, TURN_SPEED_MAX_RAD_S)
            }),
            ..*self
        }
    }

    /// The state after a measurement; `evidence` is what the frame shows of the
    /// object and around it.
    ///
    /// # Errors
    /// When the measurement is older than the state.
    pub fn updated(
        &self,
        measurement: &Measurement,
        evidence: Option<&Evidence<'_>>,
        config: &MotionConfig,
    ) -> Result<Self, Error> {
        let stamp_ns = measurement.stamp_ns();
        if stamp_ns < self.stamp_ns {
            return Err(Error::OutOfOrder {
                stamp_ns,
                state_stamp_ns: self.stamp_ns,
            });
        }
        let mut state = self.moved_on(stamp_ns, Motion::Resting, config);
        let expected = state.box_in_world();
        let measured = measurement.box_along(&expected, evidence);
        let sigmas_m = measurement.face_sigmas_m(&axes(&state.rotation), config);
        let shifts_m = faces::least_shifts_m(&measured, &expected);
        let is_whole = measured.volume_m3() >= PART_VOLUME_SHARE * expected.volume_m3();
        let is_moved = measurement.seen().is_handled()
            || state.surprise_sigmas(&shifts_m, &sigmas_m) > MANOEUVRE_SIGMAS
            || (is_whole && state.turn_surprise_sigmas(measurement) > MANOEUVRE_SIGMAS);
        if is_moved {
            state = self.moved_on(stamp_ns, Motion::Handled, config);
            if state.surprise_sigmas(&shifts_m, &sigmas_m) > JUMP_SIGMAS {
                state.allow_jump(&shifts_m, config);
            }
        }
        let view = evidence.and_then(|evidence| evidence.view.as_ref());
        let trust = faces::trust(&measured, &expected, &sigmas_m, measurement.seen(), view);
        // The box around a part of an object is turned anyhow.
        if is_whole {
            state.take_turn(&trust, measurement, is_moved);
        }
        state.take_faces(&measured, &trust, &sigmas_m);
        state.slow_unseen(&trust, (stamp_ns - self.stamp_ns) as f64 * 1e-9);
        Ok(state)
    }

    /// How many sigma the object must have moved from where it is expected, on the
    /// worst axis.
    fn surprise_sigmas(&self, shifts_m: &Vector3<f64>, sigmas_m: &Vector3<f64>) -> f64 {
        let sigmas = (0..3).map(|axis| {
            let variance_m2 = self.slides[axis].centre_m2() + sigmas_m[axis].powi(2);
            shifts_m[axis].abs() / variance_m2.sqrt()
        });
        sigmas.fold(0.0, f64::max)
    }

    /// The same of how it is turned.
    fn turn_surprise_sigmas(&self, measurement: &Measurement) -> f64 {
        let turn = self.turn_to(measurement);
        let sigmas_rad = turn_sigmas_rad(&measurement.seen().variances_m2);
        let sigmas = (0..3).map(|axis| {
            let variance_rad2 = self.turns[axis].turn_rad2() + sigmas_rad[axis].powi(2);
            turn[axis].abs() / variance_rad2.sqrt()
        });
        sigmas.fold(0.0, f64::max)
    }

    /// From the expected orientation to the nearest reading of the measured one, about
    /// the axes of the box, radians.
    fn turn_to(&self, measurement: &Measurement) -> Vector3<f64> {
        let reading = nearest_reading(measurement.box_in_world(), &self.box_in_world());
        (self.rotation.inverse() * reading.frame_from_box.rotation).scaled_axis()
    }

    /// Whether the ground of its box is about square, so that it may be round.
    fn is_square(&self) -> bool {
        let [x, y] = [self.half_sides_m.x, self.half_sides_m.y];
        x.min(y) >= SQUARE_RATIO * x.max(y)
    }

    /// Lets the object be where it is measured now. A jump against its velocity says
    /// that this was wrong.
    fn allow_jump(&mut self, shifts_m: &Vector3<f64>, config: &MotionConfig) {
        if (self.rotation * shifts_m).dot(&self.velocity_m_s) < 0.0 {
            self.velocity_m_s = Vector3::zeros();
        }
        for (slide, shift_m) in self.slides.iter_mut().zip(shifts_m.iter()) {
            *slide = slide.displaced(shift_m * shift_m, first_speed_m_s(config).powi(2));
        }
    }

    /// How what is round is turned can not be seen: as long as nothing moves it, it is
    /// turned as it was.
    fn take_turn(&mut self, trust: &[[Trust; 2]; 3], measurement: &Measurement, is_moved: bool) {
        let turn = self.turn_to(measurement);
        let is_whole = trust[..2].iter().flatten().all(|face| *face == Trust::Sure);
        let factor = if is_whole { 1.0 } else { PART_TURN_FACTOR };
        let clear_rad = turn_sigmas_rad(&measurement.seen().variances_m2);
        let sigmas_rad = clear_rad * factor;
        let mut correction = Vector3::zeros();
        for axis in 0..3 {
            let is_known = self.turns[axis].turn_rad2() <= KNOWN_SIGMA_RAD * KNOWN_SIGMA_RAD;
            let is_round = axis == UPRIGHT && self.is_square();
            if !is_moved && is_known && (is_round || clear_rad[axis] >= CLEAR_SIGMA_RAD) {
                continue;
            }
            let (measured, gain) = self.turns[axis].measured(sigmas_rad[axis].powi(2));
            self.turns[axis] = measured.settled(PI, TURN_SPEED_MAX_RAD_S);
            correction[axis] = gain[0] * turn[axis];
            self.turn_speed_rad_s[axis] += gain[1] * turn[axis];
        }
        self.turn_speed_rad_s = self.turn_speed_rad_s.cap_magnitude(TURN_SPEED_MAX_RAD_S);
        let turned = self.rotation * UnitQuaternion::from_scaled_axis(correction);
        self.rotation = UnitQuaternion::new_normalize(turned.into_inner());
    }

    fn take_faces(
        &mut self,
        measured: &OrientedBox,
        trust: &[[Trust; 2]; 3],
        sigmas_m: &Vector3<f64>,
    ) {
        let world_from_axes = axes(&self.rotation);
        let shift = world_from_axes.tr_mul(&(measured.centre() - self.position));
        let (mut moved, mut sped) = (Vector3::<f64>::zeros(), Vector3::<f64>::zeros());
        let mut completeness = 1.0_f64;
        for axis in 0..3 {
            let measured_half_m = measured.half_sides_m[axis];
            for (end, trust) in [End::Low, End::High].into_iter().zip(trust[axis]) {
                let sigma_m = match trust {
                    Trust::Sure => sigmas_m[axis],
                    Trust::Doubtful => DOUBT_SIGMA_M.max(sigmas_m[axis]),
                    Trust::Hidden => continue,
                };
                let sign = end.sign();
                let surprise_m = (shift[axis] + sign * measured_half_m)
                    - (moved[axis] + sign * self.half_sides_m[axis]);
                let (slide, gain) = self.slides[axis].face_measured(end, sigma_m * sigma_m);
                self.slides[axis] = slide.settled(SPEED_MAX_M_S);
                moved[axis] += gain[0] * surprise_m;
                sped[axis] += gain[1] * surprise_m;
                let half_m: f64 = self.half_sides_m[axis] + gain[2] * surprise_m;
                self.half_sides_m[axis] = half_m.clamp(HALF_SIDE_MIN_M, HALF_SIDE_MAX_M);
            }
            completeness *= (measured_half_m / self.half_sides_m[axis]).clamp(0.0, 1.0);
        }
        self.position += world_from_axes * moved;
        self.velocity_m_s += world_from_axes * sped;
        self.velocity_m_s = self.velocity_m_s.cap_magnitude(SPEED_MAX_M_S);
        self.completeness = completeness;
    }

    /// Along an axis of which neither face was seen nothing says that the object
    /// goes on moving.
    fn slow_unseen(&mut self, trust: &[[Trust; 2]; 3], dt_s: f64) {
        let keep = (-dt_s / UNSEEN_DAMPING_S).exp();
        let shares = trust.map(|ends| match ends {
            [Trust::Hidden, Trust::Hidden] => keep,
            _ => 1.0,
        });
        let along = self.rotation.inverse() * self.velocity_m_s;
        self.velocity_m_s = self.rotation * along.component_mul(&Vector3::from(shares));
    }

    /// Capture stamp of the state.
    pub fn stamp_ns(&self) -> u64 {
        self.stamp_ns
    }

    /// Velocity, world frame, metres a second.
    pub fn velocity_m_s(&self) -> Vector3<f64> {
        self.velocity_m_s
    }

    /// Angular velocity, world frame, radians a second.
    pub fn angular_velocity_rad_s(&self) -> Vector3<f64> {
        self.rotation * self.turn_speed_rad_s
    }

    /// Covariance of the position, world axes, square metres.
    pub fn position_covariance_m2(&self) -> Matrix3<f64> {
        in_world(&self.rotation, self.slides.map(|slide| slide.centre_m2()))
    }

    /// Covariance of the orientation, as a turn about the world's axes, square
    /// radians.
    pub fn rotation_covariance_rad2(&self) -> Matrix3<f64> {
        in_world(&self.rotation, self.turns.map(|turn| turn.turn_rad2()))
    }

    /// Share of the box that the last measurement showed, 0 to 1.
    pub fn completeness(&self) -> f64 {
        self.completeness
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

/// Standard deviation of the speed of what was not seen moving: a hand's, metres a
/// second.
fn first_speed_m_s(config: &MotionConfig) -> f64 {
    (0.5 * config.acceleration_sigma_m_s2).min(SPEED_MAX_M_S)
}

/// The axes of a box as columns, world frame.
fn axes(rotation: &UnitQuaternion<f64>) -> Matrix3<f64> {
    rotation.to_rotation_matrix().into_inner()
}

/// Variances along the axes of a box as a covariance in the world.
fn in_world(rotation: &UnitQuaternion<f64>, variances: [f64; 3]) -> Matrix3<f64> {
    let world_from_axes = axes(rotation);
    world_from_axes * Matrix3::from_diagonal(&variances.into()) * world_from_axes.transpose()
}

#[cfg(test)]
mod tests;
