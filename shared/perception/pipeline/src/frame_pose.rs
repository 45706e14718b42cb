//! Frame pose: capture stamp, camera pose, up direction and camera intrinsics of a frame.

use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{Unit, Vector3};
use point_cloud::Point;
use sensor_noise::DepthNoise;
use tracking::DepthView;

/// Capture stamp, camera pose, up direction and camera intrinsics of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FramePose {
    /// Capture stamp of the frame, nanoseconds.
    pub capture_ns: u64,
    /// Camera pose of the frame; the identity when it is unknown.
    pub world_from_camera: RigidTransform,
    /// Up direction, camera frame; `None` when unknown.
    pub up_in_camera: Option<Unit<Vector3<f64>>>,
    /// Camera intrinsics of an organised cloud; `None` disables occlusion tests.
    pub camera: Option<PinholeCamera>,
}

impl FramePose {
    /// Frame pose with the camera shifted along the world axes, metres.
    pub(crate) fn shifted(mut self, shift_m: &Vector3<f64>) -> Self {
        self.world_from_camera.translation.vector += shift_m;
        self
    }

    /// Depth image of the frame's cloud, with the camera's depth noise, for occlusion tests; `None` if
    /// the cloud is not organised.
    pub fn view<'a>(&self, cloud: &'a [Point], depth_noise: DepthNoise) -> Option<DepthView<'a>> {
        DepthView::new(cloud, self.camera?, &self.world_from_camera, depth_noise)
    }
}
