//! What one frame says of an object.

use crate::Error;
use crate::evidence::Evidence;
use crate::motion_filter::MotionConfig;
use crate::orientation::nearest_reading;
use geometry::OrientedBox;
use nalgebra::{Matrix3, Translation3, Unit, Vector3};
use sensor_noise::kinect_depth_sigma_m;

/// Farthest coordinate of an object, metres.
const COORDINATE_MAX_M: f64 = 1e5;

/// Longest half side of an object, metres.
pub(crate) const HALF_SIDE_MAX_M: f64 = 50.0;

/// Greatest variance of an object's points, square metres.
const VARIANCE_MAX_M2: f64 = HALF_SIDE_MAX_M * HALF_SIDE_MAX_M;

/// The borders of an object are ragged by this angle, radians: 1.2 pixels of a
/// Kinect v1 (Nguyen, Izadi and Lovell 2012, equation 4, surfaces facing it).
const LATERAL_SIGMA_RAD: f64 = 0.002_1;

/// A box of which a part may be missing has its centre somewhere else: this share
/// of its longest side is added to the noise of the position.
const CUT_SHARE: f64 = 0.25;

/// But at most this, metres: a table that is cut is no mug.
const CUT_MAX_M: f64 = 0.08;

/// What a hand, a person's or the robot's, has to do with an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handling {
    /// Nothing.
    Alone,
    /// It is at it, and may be moving it.
    Touched,
    /// The object's points lie where the hand is: some of them may be the hand's.
    WithinHand,
}

/// How an object was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circumstances {
    /// Distance along the camera's axis, metres.
    pub depth_m: f64,
    /// From the camera to the object, world frame.
    pub ray_in_world: Unit<Vector3<f64>>,
    /// Variances of its points along the axes of its box, square metres.
    pub variances_m2: Vector3<f64>,
    /// Whether it was seen to stand on the table, so that its box ends there.
    pub stands_on_table: bool,
    /// Whether a part of it may be missing, at the border of the image or behind
    /// what touches it.
    pub is_cut: bool,
    /// What a hand has to do with it, as far as is known.
    pub handling: Handling,
}

/// The points of what stands on a table begin so much over it at most, metres.
const FOOT_MAX_M: f64 = 0.03;

/// What one frame says of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    stamp_ns: u64,
    box_in_world: OrientedBox,
    seen: Circumstances,
}

impl Circumstances {
    /// Whether a hand may be moving the object.
    pub fn is_handled(&self) -> bool {
        self.handling != Handling::Alone
    }
}

impl Measurement {
    /// A box and how it was seen.
    ///
    /// # Errors
    /// When a number is not finite, a coordinate is beyond 100 km, a half side is
    /// negative or beyond 50 m, or a direction is none.
    pub fn new(
        stamp_ns: u64,
        box_in_world: OrientedBox,
        seen: Circumstances,
    ) -> Result<Self, Error> {
        match broken_rule(&box_in_world, &seen) {
            Some(rule) => Err(Error::ImpossibleMeasurement { rule }),
            None => Ok(Self {
                stamp_ns,
                box_in_world,
                seen,
            }),
        }
    }

    /// Capture stamp.
    pub fn stamp_ns(&self) -> u64 {
        self.stamp_ns
    }

    /// The box, world frame.
    pub fn box_in_world(&self) -> &OrientedBox {
        &self.box_in_world
    }

    /// How it was seen.
    pub fn seen(&self) -> &Circumstances {
        &self.seen
    }

    /// Variance of the position for telling objects apart, each axis, square metres.
    pub fn position_variance_m2(&self, config: &MotionConfig) -> f64 {
        let sensor_m = kinect_depth_sigma_m(self.seen.depth_m).max(config.position_sigma_min_m);
        let cut_m = if self.seen.is_cut {
            (CUT_SHARE * self.box_in_world.sides_m().max()).min(CUT_MAX_M)
        } else {
            0.0
        };
        sensor_m * sensor_m + cut_m * cut_m
    }

    /// The box around what was measured, along the axes of an expected one: around
    /// the object's points where they are given, since a box that is turned otherwise
    /// says little of these axes. Frame: world.
    pub(crate) fn box_along(
        &self,
        expected: &OrientedBox,
        evidence: Option<&Evidence<'_>>,
    ) -> OrientedBox {
        let around_points = evidence.and_then(|evidence| evidence.box_along(expected));
        let Some(mut around) = around_points else {
            return nearest_reading(&self.box_in_world, expected);
        };
        if self.seen.stands_on_table {
            // The lowest points over a table are not told from it.
            let foot = around.frame_from_box.inverse() * self.box_in_world.centre();
            let missing_m = (self.box_in_world.half_sides_m.z - foot.z - around.half_sides_m.z)
                .clamp(0.0, FOOT_MAX_M);
            around.frame_from_box *= Translation3::new(0.0, 0.0, -0.5 * missing_m);
            around.half_sides_m.z += 0.5 * missing_m;
        }
        around
    }

    /// Standard deviation of a face of the box, along each axis of a frame, metres:
    /// the noise of depth along the ray, that of borders across it.
    pub(crate) fn face_sigmas_m(
        &self,
        world_from_axes: &Matrix3<f64>,
        config: &MotionConfig,
    ) -> Vector3<f64> {
        let along = kinect_depth_sigma_m(self.seen.depth_m);
        let across = LATERAL_SIGMA_RAD * self.seen.depth_m.abs();
        let ray = world_from_axes.tr_mul(&self.seen.ray_in_world);
        ray.map(|share| {
            let share = (share * share).min(1.0);
            let variance = share * along * along + (1.0 - share) * across * across;
            variance.sqrt().max(config.face_sigma_min_m)
        })
    }
}

/// The first rule that numbers break.
fn broken_rule(shape: &OrientedBox, seen: &Circumstances) -> Option<&'static str> {
    let near = |value: &f64| value.abs() <= COORDINATE_MAX_M;
    let is_variance = |value: &f64| (0.0..=VARIANCE_MAX_M2).contains(value);
    let rules = [
        (
            shape.centre().iter().all(near),
            "its centre must lie within 100 km",
        ),
        (
            shape
                .half_sides_m
                .iter()
                .all(|side| (0.0..=HALF_SIDE_MAX_M).contains(side)),
            "its half sides must lie between 0 and 50 m",
        ),
        (
            (0.999..=1.001).contains(&shape.frame_from_box.rotation.norm()),
            "its orientation must be a unit quaternion",
        ),
        (near(&seen.depth_m), "its depth must lie within 100 km"),
        (
            (0.999..=1.001).contains(&seen.ray_in_world.norm()),
            "its ray must be a unit vector",
        ),
        (
            seen.variances_m2.iter().all(is_variance),
            "the variances of its points must lie between 0 and 2500 m²",
        ),
    ];
    rules
        .iter()
        .find(|(holds, _)| !holds)
        .map(|(_, rule)| *rule)
}
