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
    /// Bounding box of the object's points along the axes of the expected box, world frame,
    /// without points that are in the box of a neighbour and outside of the expected one. `None`
    /// without points.
    pub(crate) fn aligned_box(
        &self,
        expected: &OrientedBox,
        neighbour: Option<&OrientedBox>,
    ) -> Option<OrientedBox> {
        let box_from_camera =
            (expected.frame_from_box.inverse() * self.world_from_camera).cast::<f32>();
        let is_of_neighbour = |point: &Point| {
            neighbour.is_some_and(|neighbour| {
                let point = self.world_from_camera * point.position();
                neighbour.contains(&point, 0.0) && !expected.contains(&point, 0.0)
            })
        };
        let (mut low, mut high) = (Vector3::repeat(f32::MAX), Vector3::repeat(f32::MIN));
        let points = self
            .indices
            .iter()
            .filter_map(|i| self.cloud.get(*i as usize))
            .filter(|point| !is_of_neighbour(point));
        for point in points {
            let place = box_from_camera * nalgebra::Point3::new(point.x, point.y, point.z);
            (low, high) = (low.inf(&place.coords), high.sup(&place.coords));
        }
        let (low, high) = (low.cast::<f64>(), high.cast::<f64>());
        let is_usable = (high - low)
            .iter()
            .all(|side| side.is_finite() && *side >= 0.0);
        is_usable.then(|| OrientedBox {
            frame_from_box: expected.frame_from_box * Translation3::from(0.5 * (low + high)),
            half_sides_m: 0.5 * (high - low),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;

    #[test]
    fn points_of_a_neighbour_do_not_make_the_box_grow() {
        let point = |i: usize| Point {
            x: 0.001 * i as f32,
            color: Rgba::default(),
            ..Point::default()
        };
        let cloud: Vec<Point> = (0..=100).map(point).collect();
        let indices: Vec<u32> = (0..=100).collect();
        let context = ObservationContext {
            cloud: &cloud,
            indices: &indices,
            world_from_camera: RigidTransform::identity(),
            view: None,
        };
        let between = |low_m: f64, high_m: f64| OrientedBox {
            frame_from_box: RigidTransform::translation(0.5 * (low_m + high_m), 0.0, 0.0),
            half_sides_m: Vector3::new(0.5 * (high_m - low_m), 0.01, 0.01),
        };
        let ends_m = |neighbour: Option<OrientedBox>| {
            let expected = between(0.0, 0.0605);
            let found = context.aligned_box(&expected, neighbour.as_ref()).unwrap();
            let (centre_m, half_m) = (found.centre().x, found.half_sides_m.x);
            [centre_m - half_m, centre_m + half_m].map(|end_m| (end_m * 1e3).round())
        };
        assert_eq!(ends_m(None), [0.0, 100.0]);
        // What both boxes contain stays, and so does what neither explains.
        assert_eq!(ends_m(Some(between(0.0555, 0.2))), [0.0, 60.0]);
        assert_eq!(ends_m(Some(between(0.0705, 0.2))), [0.0, 70.0]);
    }
}
