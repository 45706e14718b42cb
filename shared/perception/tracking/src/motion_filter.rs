//! Kalman motion filter of one object: pose, velocity and size of its bounding box.

use crate::Error;
use crate::axis_kalman::{FaceSide, RotationCovariance, TranslationCovariance};
use crate::face_confidence::{self, FaceConfidence, UPRIGHT};
use crate::measurement::{HALF_SIDE_MAX_M, Measurement};
use crate::motion_config::MotionConfig;
use crate::observation_context::ObservationContext;
use crate::orientation::{nearest_equivalent_box, rotation_sigmas_rad};
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Upper limit of the linear speed of an object on a table, metres a second. Chosen.
const SPEED_MAX_M_S: f64 = 5.0;

/// Upper limit of the angular speed of an object on a table, radians a second. Chosen.
const ANGULAR_SPEED_MAX_RAD_S: f64 = 12.0;

/// Longest extrapolation of position and orientation at constant velocity, seconds.
/// Chosen.
const COAST_MAX_S: f64 = 0.3;

/// Longest time over which the predicted covariance grows, seconds. Chosen.
const COVARIANCE_GROWTH_MAX_S: f64 = 10.0;

/// Time constant with which the angular velocity decays, seconds. Chosen.
const ANGULAR_DAMPING_S: f64 = 0.3;

/// Time constant with which a velocity decays that is not observed or has no cause, seconds.
/// Chosen.
const DAMPING_S: f64 = 0.15;

/// Upper limit of the initial rotation uncertainty (standard deviation), radians (3
/// degrees). The yaw of a rotationally symmetric object is unobservable, so its first
/// orientation is kept as reference. Chosen.
const INITIAL_ROTATION_SIGMA_MAX_RAD: f64 = 0.05;

/// Initial standard deviation of the angular velocity, radians a second. Chosen.
const INITIAL_ANGULAR_SPEED_SIGMA_RAD_S: f64 = 0.05;

/// Yaw noise above which an object counts as rotationally symmetric, radians (8 degrees,
/// reached by sides in the ratio 5 to 3). Chosen.
const OBSERVABLE_YAW_SIGMA_MAX_RAD: f64 = 0.14;

/// Ratio of the shorter to the longer footprint side above which an object may be
/// rotationally symmetric. Chosen.
const SQUARE_RATIO: f64 = 0.85;

/// Standard deviation below which the orientation counts as converged, radians (6
/// degrees). Chosen.
const CONVERGED_ROTATION_SIGMA_RAD: f64 = 0.105;

/// Angular acceleration noise of an untouched object relative to a handled one. Chosen.
const RESTING_ANGULAR_ACCELERATION_RATIO: f64 = 0.02;

/// Smallest half side of a box, metres. Chosen.
const HALF_SIDE_MIN_M: f64 = 1e-3;

/// Standard deviation of a face measurement that contradicts earlier ones, metres.
/// Chosen.
const DOUBTFUL_FACE_SIGMA_M: f64 = 0.010;

/// Additional position uncertainty of a truncated box, as a fraction of its longest half
/// side: at the border of the image its points come and go. Chosen.
const TRUNCATED_SIGMA_RATIO: f64 = 0.25;

/// Volume ratio of the measured to the expected box below which the measurement shows
/// only a part of the object. Chosen.
const PARTIAL_VOLUME_RATIO: f64 = 0.8;

/// Volume ratio of the measured to the expected box below which the measurement is a
/// fragment: most of the object was found as other clusters, and the faces of the fragment
/// are hardly those of the object.
const FRAGMENT_VOLUME_RATIO: f64 = 0.5;

/// Factor on the rotation noise when a side face is not reliable. Chosen.
const PARTIAL_ROTATION_NOISE_FACTOR: f64 = 3.0;

/// Innovation gate of manoeuvre detection, in sigmas: a larger innovation is attributed
/// to a hand (99.7 % of a normal distribution lie within 3 sigma).
const MANOEUVRE_SIGMAS: f64 = 3.0;

/// Innovation gate of jump detection, in sigmas of the handled-motion model: a larger
/// innovation is a relocation, not a motion. Chosen.
const JUMP_SIGMAS: f64 = 6.0;

/// Process-noise model of a prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MotionModel {
    Resting,
    Handled,
}

/// Kalman filter (Kalman 1960) of one object's oriented bounding box, world frame.
///
/// The state is position, velocity, orientation, angular velocity and half sides. Each
/// face of a measured box is a measurement of centre and side together. Occluded faces
/// are left out, so that partial occlusion neither moves nor shrinks the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionFilter {
    stamp_ns: u64,
    position: Point3<f64>,
    velocity_m_s: Vector3<f64>,
    rotation: UnitQuaternion<f64>,
    /// Angular velocity about the axes of the box.
    angular_velocity_in_box_rad_s: Vector3<f64>,
    half_sides_m: Vector3<f64>,
    translation_covariances: [TranslationCovariance; 3],
    rotation_covariances: [RotationCovariance; 3],
    completeness: f64,
}

impl MotionFilter {
    /// Initial state of a track: at rest, with the uncertainty of the first measurement.
    pub fn start(measurement: &Measurement, config: &MotionConfig) -> Self {
        let shape = measurement.box_in_world();
        let rotation = shape.frame_from_box.rotation;
        let sigmas_m = measurement.face_sigmas_m(&axes_in_world(&rotation), config);
        let speed_m_s = initial_speed_sigma_m_s(config);
        let missing_m = if measurement.conditions().is_truncated {
            truncated_sigma_m(shape)
        } else {
            0.0
        };
        let covariance = |axis: usize| {
            let variance_m2 = sigmas_m[axis].powi(2) + missing_m * missing_m;
            TranslationCovariance::from_variances(variance_m2, speed_m_s * speed_m_s, variance_m2)
        };
        let sigmas_rad = rotation_sigmas_rad(&measurement.conditions().variances_m2);
        Self {
            stamp_ns: measurement.stamp_ns(),
            position: shape.centre(),
            velocity_m_s: Vector3::zeros(),
            rotation,
            angular_velocity_in_box_rad_s: Vector3::zeros(),
            half_sides_m: shape.half_sides_m.map(|half| half.max(HALF_SIDE_MIN_M)),
            translation_covariances: std::array::from_fn(covariance),
            rotation_covariances: std::array::from_fn(|axis| {
                // The orientation of a truncated box is arbitrary.
                let sigma_rad = if measurement.conditions().is_truncated {
                    sigmas_rad[axis]
                } else {
                    sigmas_rad[axis].min(INITIAL_ROTATION_SIGMA_MAX_RAD)
                };
                RotationCovariance::from_variances(
                    sigma_rad.powi(2),
                    INITIAL_ANGULAR_SPEED_SIGMA_RAD_S.powi(2),
                )
            }),
            completeness: 1.0,
        }
    }

    /// State predicted to a capture stamp with the handled-motion model; for an earlier
    /// stamp, the unchanged state.
    #[must_use]
    pub fn predicted(&self, stamp_ns: u64, config: &MotionConfig) -> Self {
        self.propagated(stamp_ns, MotionModel::Handled, config)
    }

    /// State of an object that has stopped: the velocities are zero, all else is kept.
    #[must_use]
    pub fn stopped(&self) -> Self {
        Self {
            velocity_m_s: Vector3::zeros(),
            angular_velocity_in_box_rad_s: Vector3::zeros(),
            ..*self
        }
    }

    fn propagated(&self, stamp_ns: u64, model: MotionModel, config: &MotionConfig) -> Self {
        let dt_s = stamp_ns.saturating_sub(self.stamp_ns) as f64 * 1e-9;
        let (acceleration_m_s2, angular_ratio) = match model {
            MotionModel::Handled => (config.acceleration_sigma_m_s2, 1.0),
            MotionModel::Resting => (
                config.resting_acceleration_sigma_m_s2,
                RESTING_ANGULAR_ACCELERATION_RATIO,
            ),
        };
        let angular_acceleration_rad_s2 = config.angular_acceleration_sigma_rad_s2 * angular_ratio;
        let (growth_s, coast_s) = (dt_s.min(COVARIANCE_GROWTH_MAX_S), dt_s.min(COAST_MAX_S));
        let size_walk_m2_s = config.size_random_walk_sigma_m * config.size_random_walk_sigma_m;
        let turn = UnitQuaternion::from_scaled_axis(self.angular_velocity_in_box_rad_s * coast_s);
        Self {
            stamp_ns: stamp_ns.max(self.stamp_ns),
            position: self.position + self.velocity_m_s * coast_s,
            rotation: UnitQuaternion::new_normalize((self.rotation * turn).into_inner()),
            angular_velocity_in_box_rad_s: self.angular_velocity_in_box_rad_s
                * (-dt_s / ANGULAR_DAMPING_S).exp(),
            translation_covariances: self.translation_covariances.map(|covariance| {
                covariance
                    .predicted(growth_s, acceleration_m_s2, size_walk_m2_s)
                    .bounded(SPEED_MAX_M_S)
            }),
            rotation_covariances: self.rotation_covariances.map(|covariance| {
                covariance
                    .predicted(growth_s, angular_acceleration_rad_s2, ANGULAR_DAMPING_S)
                    .bounded(PI, ANGULAR_SPEED_MAX_RAD_S)
            }),
            ..*self
        }
    }

    /// State after a measurement update. `context` supplies the object's points and the
    /// depth image around them.
    ///
    /// # Errors
    /// When the measurement is older than the state.
    pub fn updated(
        &self,
        measurement: &Measurement,
        context: Option<&ObservationContext<'_>>,
        config: &MotionConfig,
    ) -> Result<Self, Error> {
        let stamp_ns = measurement.stamp_ns();
        if stamp_ns < self.stamp_ns {
            return Err(Error::OutOfOrder {
                stamp_ns,
                state_stamp_ns: self.stamp_ns,
            });
        }
        let mut state = self.propagated(stamp_ns, MotionModel::Resting, config);
        let expected = state.box_in_world();
        let measured = measurement.aligned_box(&expected, context);
        let conditions = measurement.conditions();
        let is_cut = conditions.is_truncated && !conditions.is_handled();
        let is_fragment = !conditions.is_handled()
            && measured.volume_m3() < FRAGMENT_VOLUME_RATIO * expected.volume_m3();
        let missing_m = if is_cut || is_fragment {
            truncated_sigma_m(&expected)
        } else {
            0.0
        };
        let sigmas_m = measurement
            .face_sigmas_m(&axes_in_world(&state.rotation), config)
            .map(|sigma_m| sigma_m.hypot(missing_m));
        let shifts_m = face_confidence::minimal_shifts_m(&measured, &expected);
        let is_whole =
            !is_cut && measured.volume_m3() >= PARTIAL_VOLUME_RATIO * expected.volume_m3();
        let is_moved = measurement.conditions().is_handled()
            || state.translation_innovation_sigmas(&shifts_m, &sigmas_m) > MANOEUVRE_SIGMAS
            || (is_whole && state.rotation_innovation_sigmas(measurement) > MANOEUVRE_SIGMAS);
        if is_moved {
            state = self.propagated(stamp_ns, MotionModel::Handled, config);
            if state.translation_innovation_sigmas(&shifts_m, &sigmas_m) > JUMP_SIGMAS {
                state.inflate_after_jump(&shifts_m, config);
            }
        }
        let view = context.and_then(|context| context.view.as_ref());
        let confidences = face_confidence::face_confidences(
            &measured,
            &expected,
            &sigmas_m,
            measurement.conditions(),
            view,
        );
        // The orientation of a partial box is arbitrary.
        if is_whole {
            state.update_rotation(&confidences, measurement, is_moved);
        }
        state.update_faces(&measured, &confidences, &sigmas_m);
        let dt_s = (stamp_ns - self.stamp_ns) as f64 * 1e-9;
        if measurement.is_at_rest() {
            state.velocity_m_s *= damping(dt_s);
        } else {
            state.damp_unobserved_axes(&confidences, dt_s);
        }
        Ok(state)
    }

    /// Translation innovation in sigmas, on the worst axis.
    fn translation_innovation_sigmas(
        &self,
        shifts_m: &Vector3<f64>,
        sigmas_m: &Vector3<f64>,
    ) -> f64 {
        let sigmas = (0..3).map(|axis| {
            let variance_m2 =
                self.translation_covariances[axis].centre_variance_m2() + sigmas_m[axis].powi(2);
            shifts_m[axis].abs() / variance_m2.sqrt()
        });
        sigmas.fold(0.0, f64::max)
    }

    /// Rotation innovation in sigmas, on the worst axis.
    fn rotation_innovation_sigmas(&self, measurement: &Measurement) -> f64 {
        let innovation = self.rotation_innovation(measurement);
        let sigmas_rad = rotation_sigmas_rad(&measurement.conditions().variances_m2);
        let sigmas = (0..3).map(|axis| {
            let variance_rad2 =
                self.rotation_covariances[axis].rotation_variance_rad2() + sigmas_rad[axis].powi(2);
            innovation[axis].abs() / variance_rad2.sqrt()
        });
        sigmas.fold(0.0, f64::max)
    }

    /// Rotation from the expected orientation to the nearest symmetry-equivalent of the
    /// measured one, about the axes of the box, radians.
    fn rotation_innovation(&self, measurement: &Measurement) -> Vector3<f64> {
        let equivalent = nearest_equivalent_box(measurement.box_in_world(), &self.box_in_world());
        (self.rotation.inverse() * equivalent.frame_from_box.rotation).scaled_axis()
    }

    /// True if the footprint is nearly square, so that the object may be rotationally
    /// symmetric.
    fn has_square_footprint(&self) -> bool {
        let [x, y] = [self.half_sides_m.x, self.half_sides_m.y];
        x.min(y) >= SQUARE_RATIO * x.max(y)
    }

    /// Inflates the covariance so that the state can jump to the measured position. A
    /// jump against the velocity resets the velocity.
    fn inflate_after_jump(&mut self, shifts_m: &Vector3<f64>, config: &MotionConfig) {
        if (self.rotation * shifts_m).dot(&self.velocity_m_s) < 0.0 {
            self.velocity_m_s = Vector3::zeros();
        }
        for (covariance, shift_m) in self.translation_covariances.iter_mut().zip(shifts_m.iter()) {
            *covariance =
                covariance.after_jump(shift_m * shift_m, initial_speed_sigma_m_s(config).powi(2));
        }
    }

    /// Rotation update. The yaw of a rotationally symmetric object is unobservable: it
    /// stays unchanged until the object is moved.
    fn update_rotation(
        &mut self,
        confidences: &[[FaceConfidence; 2]; 3],
        measurement: &Measurement,
        is_moved: bool,
    ) {
        let innovation = self.rotation_innovation(measurement);
        let is_whole = confidences[..2]
            .iter()
            .flatten()
            .all(|face| *face == FaceConfidence::Reliable);
        let factor = if is_whole {
            1.0
        } else {
            PARTIAL_ROTATION_NOISE_FACTOR
        };
        let whole_sigmas_rad = rotation_sigmas_rad(&measurement.conditions().variances_m2);
        let sigmas_rad = whole_sigmas_rad * factor;
        let mut correction = Vector3::zeros();
        for axis in 0..3 {
            let has_converged = self.rotation_covariances[axis].rotation_variance_rad2()
                <= CONVERGED_ROTATION_SIGMA_RAD * CONVERGED_ROTATION_SIGMA_RAD;
            let may_be_symmetric = axis == UPRIGHT && self.has_square_footprint();
            if !is_moved
                && has_converged
                && (may_be_symmetric || whole_sigmas_rad[axis] >= OBSERVABLE_YAW_SIGMA_MAX_RAD)
            {
                continue;
            }
            let (measured, gain) =
                self.rotation_covariances[axis].updated(sigmas_rad[axis].powi(2));
            self.rotation_covariances[axis] = measured.bounded(PI, ANGULAR_SPEED_MAX_RAD_S);
            correction[axis] = gain[0] * innovation[axis];
            self.angular_velocity_in_box_rad_s[axis] += gain[1] * innovation[axis];
        }
        self.angular_velocity_in_box_rad_s = self
            .angular_velocity_in_box_rad_s
            .cap_magnitude(ANGULAR_SPEED_MAX_RAD_S);
        let turned = self.rotation * UnitQuaternion::from_scaled_axis(correction);
        self.rotation = UnitQuaternion::new_normalize(turned.into_inner());
    }

    /// Position and size update from the faces that are not occluded.
    fn update_faces(
        &mut self,
        measured: &OrientedBox,
        confidences: &[[FaceConfidence; 2]; 3],
        sigmas_m: &Vector3<f64>,
    ) {
        let world_from_axes = axes_in_world(&self.rotation);
        let shift = world_from_axes.tr_mul(&(measured.centre() - self.position));
        let (mut moved, mut velocity_change) = (Vector3::<f64>::zeros(), Vector3::<f64>::zeros());
        let mut completeness = 1.0_f64;
        for axis in 0..3 {
            let measured_half_m = measured.half_sides_m[axis];
            for (side, confidence) in [FaceSide::Negative, FaceSide::Positive]
                .into_iter()
                .zip(confidences[axis])
            {
                let sigma_m = match confidence {
                    FaceConfidence::Reliable => sigmas_m[axis],
                    FaceConfidence::Doubtful => DOUBTFUL_FACE_SIGMA_M.max(sigmas_m[axis]),
                    FaceConfidence::Occluded => continue,
                };
                let sign = side.sign();
                let innovation_m = (shift[axis] + sign * measured_half_m)
                    - (moved[axis] + sign * self.half_sides_m[axis]);
                let (covariance, gain) =
                    self.translation_covariances[axis].updated_by_face(side, sigma_m * sigma_m);
                self.translation_covariances[axis] = covariance.bounded(SPEED_MAX_M_S);
                moved[axis] += gain[0] * innovation_m;
                if confidence == FaceConfidence::Reliable {
                    // A doubtful face tells of another segmentation, not of motion.
                    velocity_change[axis] += gain[1] * innovation_m;
                }
                let half_m: f64 = self.half_sides_m[axis] + gain[2] * innovation_m;
                self.half_sides_m[axis] = half_m.clamp(HALF_SIDE_MIN_M, HALF_SIDE_MAX_M);
            }
            completeness *= (measured_half_m / self.half_sides_m[axis]).clamp(0.0, 1.0);
        }
        self.position += world_from_axes * moved;
        self.velocity_m_s += world_from_axes * velocity_change;
        self.velocity_m_s = self.velocity_m_s.cap_magnitude(SPEED_MAX_M_S);
        self.completeness = completeness;
    }

    /// Decay of the velocity along axes without a reliable face, where no motion is
    /// observable.
    fn damp_unobserved_axes(&mut self, confidences: &[[FaceConfidence; 2]; 3], dt_s: f64) {
        let keep = damping(dt_s);
        let shares = confidences.map(|ends| {
            if ends.contains(&FaceConfidence::Reliable) {
                1.0
            } else {
                keep
            }
        });
        let along = self.rotation.inverse() * self.velocity_m_s;
        self.velocity_m_s = self.rotation * along.component_mul(&Vector3::from(shares));
    }

    /// Capture stamp of the filter state, nanoseconds.
    pub fn stamp_ns(&self) -> u64 {
        self.stamp_ns
    }

    /// Linear velocity, world frame, metres a second.
    pub fn velocity_m_s(&self) -> Vector3<f64> {
        self.velocity_m_s
    }

    /// Angular velocity, world frame, radians a second.
    pub fn angular_velocity_rad_s(&self) -> Vector3<f64> {
        self.rotation * self.angular_velocity_in_box_rad_s
    }

    /// Covariance of the position, world axes, square metres.
    pub fn position_covariance_m2(&self) -> Matrix3<f64> {
        covariance_in_world(
            &self.rotation,
            self.translation_covariances
                .map(|covariance| covariance.centre_variance_m2()),
        )
    }

    /// Covariance of the orientation as a small rotation about the world axes, square
    /// radians.
    pub fn rotation_covariance_rad2(&self) -> Matrix3<f64> {
        covariance_in_world(
            &self.rotation,
            self.rotation_covariances
                .map(|turn| turn.rotation_variance_rad2()),
        )
    }

    /// Visible fraction of the box in the last measurement, 0 to 1.
    pub fn completeness(&self) -> f64 {
        self.completeness
    }

    /// Oriented bounding box, world frame. Its centre and axes are the object's pose.
    pub fn box_in_world(&self) -> OrientedBox {
        let translation = Translation3::from(self.position.coords);
        OrientedBox {
            frame_from_box: RigidTransform::from_parts(translation, self.rotation),
            half_sides_m: self.half_sides_m,
        }
    }
}

/// Fraction of an unobserved or uncaused velocity that is left after a time.
fn damping(dt_s: f64) -> f64 {
    (-dt_s / DAMPING_S).exp()
}

/// Initial standard deviation of the speed, metres a second: that of a hand-held object.
fn initial_speed_sigma_m_s(config: &MotionConfig) -> f64 {
    (0.5 * config.acceleration_sigma_m_s2).min(SPEED_MAX_M_S)
}

/// Additional standard deviation of the faces of a truncated box, metres.
fn truncated_sigma_m(shape: &OrientedBox) -> f64 {
    TRUNCATED_SIGMA_RATIO * shape.half_sides_m.max()
}

/// Axes of a box as matrix columns, world frame.
fn axes_in_world(rotation: &UnitQuaternion<f64>) -> Matrix3<f64> {
    rotation.to_rotation_matrix().into_inner()
}

/// World-frame covariance from variances along the axes of a box.
fn covariance_in_world(rotation: &UnitQuaternion<f64>, variances: [f64; 3]) -> Matrix3<f64> {
    let world_from_axes = axes_in_world(rotation);
    world_from_axes * Matrix3::from_diagonal(&variances.into()) * world_from_axes.transpose()
}

#[cfg(test)]
mod tests;
