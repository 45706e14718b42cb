//! Detection input: the cloud of one frame and the scene priors.

use crate::body_map::BodyMap;
use geometry::{Capsule, OrientedBox, Plane, RigidTransform};
use nalgebra::{Unit, Vector3};
use point_cloud::{ColorHistogram, OrganizedCloud};

/// Detection input: one point cloud, the up direction and scene priors.
#[derive(Debug, Clone, Copy)]
pub struct DetectionInput<'a> {
    /// Point cloud in the camera frame, metres. A cloud of a single row or column has
    /// no image grid; it may be in any frame and merged from several views.
    pub cloud: OrganizedCloud<'a>,
    /// Up direction in the frame of the cloud; `None` when the camera's pose is unknown.
    pub up_in_camera: Option<Unit<Vector3<f64>>>,
    /// Scene priors: people, robot and live tracks.
    pub priors: ScenePriors<'a>,
}

/// Scene priors in the camera frame: people, robot, table and live tracks. The default
/// knows nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ScenePriors<'a> {
    /// Capsules of people; `None` when no source reports people.
    pub instructor: Option<&'a [Capsule]>,
    /// Capsules of the robot's links; `None` when no source reports the robot.
    pub robot: Option<&'a [Capsule]>,
    /// Bodies found in depth in the previous frame; `None` for a single frame.
    pub bodies: Option<&'a BodyMap>,
    /// Camera pose of the frame, by which motion since earlier frames is measured; the identity
    /// when it is unknown.
    pub world_from_camera: RigidTransform,
    /// Planes of the support surfaces of earlier frames, predicted to this frame, camera frame, the
    /// table first: they stay while they are seen. Empty when the image alone decides.
    pub surfaces: &'a [Plane],
    /// Live tracks, with boxes predicted to this frame.
    pub tracks: &'a [ExpectedTrack],
}

/// Live track predicted to the frame that is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedTrack {
    /// Predicted box of the track, camera frame.
    pub oriented_box: OrientedBox,
    /// Number of points at the last observation. 0 marks a box that may be empty; no
    /// cluster is split by it.
    pub n_points: usize,
    /// `true` while a hand moves the object and may hide any part of it.
    pub is_handled: bool,
    /// Colours of the object; `None` when they are not known.
    pub colors: Option<ColorHistogram>,
}

impl From<OrientedBox> for ExpectedTrack {
    fn from(shape: OrientedBox) -> Self {
        Self {
            oriented_box: shape,
            n_points: 0,
            is_handled: false,
            colors: None,
        }
    }
}
