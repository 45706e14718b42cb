//! Observation context of a track: its points and the surrounding depth image.

use crate::depth_view::DepthView;
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Translation3, Vector3};
use point_cloud::Point;

/// Points of one object in a frame together with the whole frame.
#[derive(Debug, Clone, Copy)]
pub struct ObservationContext<'a> {
    /// Point cloud of the whole frame. *Frame*: camera.
    pub cloud: &'a [Point],
    /// Indices of the object's points in the cloud.
    pub indices: &'a [u32],
    /// Pose of the camera, `world_from_camera`.
    pub world_from_camera: RigidTransform,
    /// Depth image for occlusion tests; `None` when the cloud is not organised.
    pub view: Option<DepthView<'a>>,
}

impl ObservationContext<'_> {
    /// Bounding box of the object's points along the axes of another box, world frame.
    /// `None` without points.
    pub(crate) fn aligned_box(&self, axes_of: &OrientedBox) -> Option<OrientedBox> {
        let box_from_camera =
            (axes_of.frame_from_box.inverse() * self.world_from_camera).cast::<f32>();
        let (mut low, mut high) = (Vector3::repeat(f32::MAX), Vector3::repeat(f32::MIN));
        let points = self
            .indices
            .iter()
            .filter_map(|i| self.cloud.get(*i as usize));
        for point in points {
            let place = box_from_camera * nalgebra::Point3::new(point.x, point.y, point.z);
            (low, high) = (low.inf(&place.coords), high.sup(&place.coords));
        }
        let (low, high) = (low.cast::<f64>(), high.cast::<f64>());
        let is_usable = (high - low)
            .iter()
            .all(|side| side.is_finite() && *side >= 0.0);
        is_usable.then(|| OrientedBox {
            frame_from_box: axes_of.frame_from_box * Translation3::from(0.5 * (low + high)),
            half_sides_m: 0.5 * (high - low),
        })
    }
}
