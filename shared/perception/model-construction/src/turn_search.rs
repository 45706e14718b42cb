//! Search of the turn by which an object was placed anew: about the vertical, all around.

use crate::Error;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use registration::{Prior, Registration, ViewSurface, register};

/// Number of turns that are tried: every 15°, which a registration bridges.
const N_TURNS: i32 = 24;

/// Uncertainty of the place of each start, metres.
const TRANSLATION_SIGMA_M: f64 = 0.02;

/// Rotation about a horizontal axis from which a result is none, radians. Chosen: the object
/// stands upright, and the camera's pose is known to some degrees.
const TILT_MAX_RAD: f64 = 0.25;

/// Contradiction of the model, of what the view should have seen of it, from which a result is none.
/// Chosen: right turns of scanned objects have 0.3, those of thin ones up to 0.6.
const TARGET_CONTRADICTION_MAX: f64 = 0.65;

/// Settings of a search.
struct SearchSettings {
    /// Number of turns to either side of the expected one that are tried.
    n_around: i32,
    /// Weight of the turn off the expected one in the score of a result, for each radian.
    turn_weight: f64,
    /// Uncertainty of the rotation of each start, radians.
    rotation_sigma_rad: f64,
    /// Share of the view that must lie on the model.
    common_share_min: f64,
}

/// Settings of a turn that may be any. Chosen: of two that fit alike, the smaller turn is the more
/// probable one, but colours decide; half of the view lies on the model after a turn of 30°, and a
/// hand beside the object does not.
const ANY_TURN: SearchSettings = SearchSettings {
    n_around: N_TURNS / 2,
    turn_weight: 0.1,
    rotation_sigma_rad: 0.15,
    common_share_min: 0.5,
};

/// Settings of a turn that is known. Chosen: a person turns to some degrees, and after the narrow
/// side of a box most of the next view is new.
const KNOWN_TURN: SearchSettings = SearchSettings {
    n_around: 2,
    turn_weight: 1.3,
    rotation_sigma_rad: 0.08,
    common_share_min: 0.35,
};

/// Weight of the share of new surface in the score of a result. Chosen.
const NEW_SURFACE_WEIGHT: f64 = 0.2;

/// Result of a turn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turned {
    pub(crate) registration: Registration,
    /// Pose of the camera from which the registration started, in the frame of the object.
    pub(crate) expected: Isometry3<f64>,
    score: f64,
}

/// Search of the pose of a camera before an object that was turned about the vertical, the z axis
/// of its frame.
#[derive(Debug)]
pub(crate) struct TurnSearch {
    /// Pose of the camera, if the object had not been turned.
    pub(crate) object_from_camera: Isometry3<f64>,
    /// Middle of the model.
    pub(crate) middle: Point3<f64>,
    /// Turn of the object that is expected, counter-clockwise from above, radians.
    pub(crate) expected_rad: Option<f64>,
}

impl TurnSearch {
    /// Registers the view with what its camera should see of the model in each turn. Returns the
    /// registration that contradicts model and view least in shape and colour, of those in which
    /// enough of the view lies on the model.
    pub(crate) fn run(
        &self,
        view: &ViewSurface,
        target: impl Fn(&Point3<f64>) -> Result<ViewSurface, Error>,
    ) -> Option<Turned> {
        let (middle_rad, settings) = match self.expected_rad {
            Some(turn_rad) => (turn_rad, &KNOWN_TURN),
            None => (0.0, &ANY_TURN),
        };
        let middle = self.start(middle_rad, view);
        let found = (-settings.n_around..=settings.n_around).filter_map(|index| {
            let off_rad = std::f64::consts::TAU * f64::from(index) / f64::from(N_TURNS);
            let start = self.start(middle_rad + off_rad, view);
            let target = target(&Point3::from(start.translation.vector)).ok()?;
            let expected = brought_to(&start, &view.centroid(), &target.centroid());
            let prior = Prior {
                target_from_source: expected,
                translation_sigma_m: TRANSLATION_SIGMA_M,
                rotation_sigma_rad: settings.rotation_sigma_rad,
            };
            let registration = register(&target, view, &prior).ok()?;
            let is_fitting = fits(&registration, &expected, settings.common_share_min);
            is_fitting.then(|| Turned {
                registration,
                expected,
                score: disagreement(&registration)
                    + settings.turn_weight
                        * turn_between_rad(&middle, &registration.target_from_source),
            })
        });
        found.min_by(|a, b| a.score.total_cmp(&b.score))
    }

    /// Pose of the camera after a turn of the object, with the middle of the view at that of the
    /// model.
    fn start(&self, turn_rad: f64, view: &ViewSurface) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -turn_rad);
        let turned = turn * self.object_from_camera;
        brought_to(&turned, &view.centroid(), &self.middle)
    }
}

/// `true` if a registration has enough in common, and leaves the object upright.
fn fits(found: &Registration, expected: &Isometry3<f64>, common_share_min: f64) -> bool {
    tilt_rad(&found.target_from_source, expected) < TILT_MAX_RAD
        && found.common_share >= common_share_min
        && found.target_contradiction <= TARGET_CONTRADICTION_MAX
}

/// Disagreement of model and view in shape and colour. Surface that only the view has is new, and
/// counts less than what the view should have seen of the model.
fn disagreement(found: &Registration) -> f64 {
    let color = found.color_difference.unwrap_or(0.0);
    found.target_contradiction + color + NEW_SURFACE_WEIGHT * (1.0 - found.common_share)
}

/// Angle of the turn about the vertical from one pose to another, radians, 0 to π.
fn turn_between_rad(one: &Isometry3<f64>, other: &Isometry3<f64>) -> f64 {
    let turn = other.rotation * one.rotation.inverse();
    turn.scaled_axis().z.abs()
}

/// Pose with another translation, such that a point lies at a place.
fn brought_to(pose: &Isometry3<f64>, point: &Point3<f64>, place: &Point3<f64>) -> Isometry3<f64> {
    Translation3::from(place - pose * point) * pose
}

/// Angle between the up directions of two poses, radians.
fn tilt_rad(one: &Isometry3<f64>, other: &Isometry3<f64>) -> f64 {
    let up = |pose: &Isometry3<f64>| pose.rotation.inverse() * Vector3::z();
    up(one).angle(&up(other))
}
