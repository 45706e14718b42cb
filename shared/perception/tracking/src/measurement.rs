//! Measurement of an object in one frame: oriented bounding box and noise model.

use crate::Error;
use crate::motion_config::MotionConfig;
use crate::observation_context::ObservationContext;
use crate::orientation::nearest_equivalent_box;
use crate::viewing_conditions::ViewingConditions;
use geometry::OrientedBox;
use nalgebra::{Matrix3, Translation3, Vector3};

/// Largest coordinate of an object, metres.
const COORDINATE_MAX_M: f64 = 1e5;

/// Largest half side of an object, metres.
pub(crate) const HALF_SIDE_MAX_M: f64 = 50.0;

/// Largest standard deviation of a depth, metres.
const DEPTH_SIGMA_MAX_M: f64 = 10.0;

/// Largest variance of an object's points, square metres.
const VARIANCE_MAX_M2: f64 = HALF_SIDE_MAX_M * HALF_SIDE_MAX_M;

/// Angular noise of an object's silhouette, radians: 1.2 pixels of a Kinect v1 (Nguyen,
/// Izadi and Lovell 2012, equation 4, surfaces facing the camera).
const LATERAL_SIGMA_RAD: f64 = 0.002_1;

/// Additional position noise of a truncated box, as a fraction of its longest side,
/// because its centre is shifted. Chosen.
const TRUNCATED_SIGMA_RATIO: f64 = 0.25;

/// Upper limit of the additional position noise of a truncated box, metres. Chosen.
const TRUNCATED_SIGMA_MAX_M: f64 = 0.08;

/// Standard deviation of the box centre due to segmentation, as a fraction of the longest
/// side: points at the rim of an object are found in one frame and missed in the next.
/// Chosen.
const SEGMENTATION_SIGMA_RATIO: f64 = 0.05;

/// Largest gap between the table and the lowest points of an object that stands on it,
/// metres. Chosen.
const FOOT_GAP_MAX_M: f64 = 0.03;

/// Measured oriented bounding box with stamp and viewing conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    stamp_ns: u64,
    box_in_world: OrientedBox,
    conditions: ViewingConditions,
    /// Standard deviation of the camera position, metres.
    pose_sigma_m: f64,
    /// `true` when nothing near the object is handled.
    is_at_rest: bool,
    /// Predicted box of another object that may touch this one, world frame.
    neighbour: Option<OrientedBox>,
}

impl Measurement {
    /// Validated measurement from a box and its viewing conditions.
    ///
    /// # Errors
    /// When a number is not finite, a coordinate is beyond 100 km, a half side is
    /// negative or beyond 50 m, the depth noise is negative or beyond 10 m, or a direction is
    /// none.
    pub fn new(
        stamp_ns: u64,
        box_in_world: OrientedBox,
        conditions: ViewingConditions,
    ) -> Result<Self, Error> {
        match violated_constraint(&box_in_world, &conditions) {
            Some(rule) => Err(Error::ImpossibleMeasurement { rule }),
            None => Ok(Self {
                stamp_ns,
                box_in_world,
                conditions,
                pose_sigma_m: 0.0,
                is_at_rest: false,
                neighbour: None,
            }),
        }
    }

    /// The same measurement with an uncertain camera pose: the noise of its faces includes
    /// this standard deviation of the camera's position, metres; 0 unless it is finite.
    #[must_use]
    pub fn with_pose_sigma_m(self, pose_sigma_m: f64) -> Self {
        Self {
            pose_sigma_m: if pose_sigma_m.is_finite() {
                pose_sigma_m.abs().min(COORDINATE_MAX_M)
            } else {
                0.0
            },
            ..self
        }
    }

    /// The same measurement with the knowledge that nothing near the object is handled, or that
    /// something is. Without a hand, or an object that a hand moves, an object has no reason to
    /// go on moving.
    #[must_use]
    pub fn with_rest(self, is_at_rest: bool) -> Self {
        Self { is_at_rest, ..self }
    }

    /// The same measurement beside another object, given by its predicted box, world frame.
    /// Points in that box and outside of this object's own are taken as points of the other: where
    /// two things touch, the border between them is only as exact as the boxes that drew it.
    #[must_use]
    pub fn with_neighbour(self, neighbour: Option<OrientedBox>) -> Self {
        Self { neighbour, ..self }
    }

    /// `true` when nothing near the object is handled.
    pub fn is_at_rest(&self) -> bool {
        self.is_at_rest
    }

    /// Standard deviation of the camera's position, metres.
    pub fn pose_sigma_m(&self) -> f64 {
        self.pose_sigma_m
    }

    /// Capture stamp of the measurement, nanoseconds.
    pub fn stamp_ns(&self) -> u64 {
        self.stamp_ns
    }

    /// Measured oriented bounding box, world frame.
    pub fn box_in_world(&self) -> &OrientedBox {
        &self.box_in_world
    }

    /// Viewing conditions of the measurement.
    pub fn conditions(&self) -> &ViewingConditions {
        &self.conditions
    }

    /// Variance of the box centre for data association, per axis, square metres.
    pub fn position_variance_m2(&self, config: &MotionConfig) -> f64 {
        let sensor_m = self
            .conditions
            .depth_sigma_m()
            .max(config.position_sigma_min_m);
        let truncation_m = if self.conditions.is_truncated {
            (TRUNCATED_SIGMA_RATIO * self.box_in_world.sides_m().max()).min(TRUNCATED_SIGMA_MAX_M)
        } else {
            0.0
        };
        let segmentation_m = SEGMENTATION_SIGMA_RATIO * self.box_in_world.sides_m().max();
        sensor_m * sensor_m + truncation_m * truncation_m + segmentation_m * segmentation_m
    }

    /// Measured box along the axes of an expected one, world frame. It encloses the
    /// object's points where they are available, since a box with other axes says little
    /// about these.
    pub(crate) fn aligned_box(
        &self,
        expected: &OrientedBox,
        context: Option<&ObservationContext<'_>>,
    ) -> OrientedBox {
        let neighbour = self.neighbour.as_ref();
        let around_points = context.and_then(|context| context.aligned_box(expected, neighbour));
        let Some(mut around) = around_points else {
            return nearest_equivalent_box(&self.box_in_world, expected);
        };
        if self.conditions.stands_on_table {
            // Detection removes the lowest points together with the table.
            let foot = around.frame_from_box.inverse() * self.box_in_world.centre();
            let missing_m = (self.box_in_world.half_sides_m.z - foot.z - around.half_sides_m.z)
                .clamp(0.0, FOOT_GAP_MAX_M);
            around.frame_from_box *= Translation3::new(0.0, 0.0, -0.5 * missing_m);
            around.half_sides_m.z += 0.5 * missing_m;
        }
        around
    }

    /// Standard deviation of a box face along each axis of a frame, metres: depth noise
    /// along the ray, silhouette noise across it, and the noise of the camera pose.
    pub(crate) fn face_sigmas_m(
        &self,
        world_from_axes: &Matrix3<f64>,
        config: &MotionConfig,
    ) -> Vector3<f64> {
        let along = self.conditions.depth_sigma_m();
        let across = LATERAL_SIGMA_RAD * self.conditions.depth_m.abs();
        let ray = world_from_axes.tr_mul(&self.conditions.ray_in_world);
        ray.map(|share| {
            let share = (share * share).min(1.0);
            let variance = share * along * along + (1.0 - share) * across * across;
            let sensor_m = variance.sqrt().max(config.face_sigma_min_m);
            sensor_m.hypot(self.pose_sigma_m)
        })
    }
}

/// First violated constraint of a measurement; `None` if it is valid.
fn violated_constraint(
    shape: &OrientedBox,
    conditions: &ViewingConditions,
) -> Option<&'static str> {
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
        (
            near(&conditions.depth_m),
            "its depth must lie within 100 km",
        ),
        (
            (0.0..=DEPTH_SIGMA_MAX_M).contains(&conditions.depth_sigma_m()),
            "the noise of its depth must lie between 0 and 10 m",
        ),
        (
            (0.999..=1.001).contains(&conditions.ray_in_world.norm()),
            "its ray must be a unit vector",
        ),
        (
            conditions.variances_m2.iter().all(is_variance),
            "the variances of its points must lie between 0 and 2500 m²",
        ),
    ];
    rules
        .iter()
        .find(|(holds, _)| !holds)
        .map(|(_, rule)| *rule)
}
