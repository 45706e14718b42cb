//! What of a frame a track is updated with, besides its measurement.

use crate::depth_view::DepthView;
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Translation3, Vector3};
use point_cloud::Point;

/// The points of an object in a frame, and the frame around them.
#[derive(Debug, Clone, Copy)]
pub struct Evidence<'a> {
    /// The whole cloud, camera frame.
    pub cloud: &'a [Point],
    /// The object's points in it.
    pub indices: &'a [u32],
    /// Pose of the camera.
    pub world_from_camera: RigidTransform,
    /// A view into the frame, where it is an image.
    pub view: Option<DepthView<'a>>,
}

impl Evidence<'_> {
    /// The box around the object's points with the axes of another one; `None`
    /// without points. Frame: world.
    pub(crate) fn box_along(&self, axes_of: &OrientedBox) -> Option<OrientedBox> {
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
