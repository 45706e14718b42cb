//! Frame pose: capture stamp, camera pose and camera intrinsics of a frame.

use geometry::{PinholeCamera, RigidTransform};
use point_cloud::Point;
use tracking::DepthView;

/// Capture stamp, camera pose and camera intrinsics of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FramePose {
    /// Capture stamp of the frame, nanoseconds.
    pub capture_ns: u64,
    /// Camera pose of the frame; the identity when it is unknown.
    pub world_from_camera: RigidTransform,
    /// Camera intrinsics of an organised cloud; `None` disables occlusion tests.
    pub camera: Option<PinholeCamera>,
}

impl FramePose {
    /// Depth image of the frame's cloud for occlusion tests; `None` if the cloud is not
    /// organised.
    pub fn view<'a>(&self, cloud: &'a [Point]) -> Option<DepthView<'a>> {
        DepthView::new(cloud, self.camera?, &self.world_from_camera)
    }
}
