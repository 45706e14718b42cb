//! Views of an object: as they come, and as they are kept in a model.

use crate::depth_view::DepthView;
use crate::pose_filter::PoseSigma;
use geometry::PinholeCamera;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use point_cloud::Point;

/// View of an object.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Segmented points of the object in the frame of the camera.
    pub points: &'a [Point],
    /// Intrinsics of the camera.
    pub camera: PinholeCamera,
    /// Capture time, nanoseconds.
    pub captured_ns: u64,
    /// Pose of the camera that the robot reports; `None` when it is not known, as for a camera that
    /// is held in the hand.
    pub world_from_camera: Option<Isometry3<f64>>,
    /// Uncertainty of the reported pose.
    pub sigma: PoseSigma,
    /// Up direction in the frame of the camera, for a camera whose pose is not known.
    pub up_in_camera: Option<UnitVector3<f64>>,
    /// Number of the placement: another one than that of the view before when somebody has turned
    /// or moved the object in between. It stands as upright in all placements.
    pub placement: u32,
}

impl View<'_> {
    /// `false` for a reported pose with a coordinate that is not finite.
    pub(crate) fn is_pose_finite(&self) -> bool {
        let is_finite = |pose: &Isometry3<f64>| {
            let rotation = pose.rotation.coords.iter();
            let mut values = rotation.chain(&pose.translation.vector);
            values.all(|value| value.is_finite())
        };
        self.world_from_camera.as_ref().is_none_or(is_finite)
    }

    /// Pose of the camera in the world; of a camera whose pose is not known, in a world with its
    /// up direction, or that of a level camera.
    pub(crate) fn world_from_camera(&self) -> Isometry3<f64> {
        let up = self.up_in_camera.unwrap_or(-Vector3::y_axis());
        self.world_from_camera
            .unwrap_or_else(|| upright_world_from_camera(&up))
    }
}

/// Accepted view of a model.
#[derive(Debug)]
pub struct BuiltView {
    pub(crate) depth: DepthView,
    /// Capture time, nanoseconds.
    pub captured_ns: u64,
    /// Pose of the camera in the frame of the object.
    pub object_from_camera: Isometry3<f64>,
    /// Pose that the robot reported, in the frame of the object; the expected one when it is not
    /// known.
    pub reported: Isometry3<f64>,
    /// Pose that was expected before the registration: the reported one, filtered.
    pub expected: Isometry3<f64>,
    pub(crate) sigma: PoseSigma,
}

impl BuiltView {
    /// Unit vector from the centre of the object's frame to the camera.
    pub fn direction(&self) -> Vector3<f64> {
        let camera = self.object_from_camera.translation.vector;
        camera.try_normalize(0.0).unwrap_or_else(Vector3::z)
    }
}

/// Pose of a camera at the origin of a world whose z axis is up, and whose x axis is the horizontal
/// direction of view; of the image's upper edge for a camera that looks straight up or down.
fn upright_world_from_camera(up: &UnitVector3<f64>) -> Isometry3<f64> {
    let horizontal = |direction: Vector3<f64>| {
        UnitVector3::try_new(direction - up.dot(&direction) * up.into_inner(), 1e-3)
    };
    let ahead = horizontal(Vector3::z())
        .or_else(|| horizontal(-Vector3::y()))
        .unwrap_or_else(Vector3::x_axis);
    let left = up.cross(&ahead);
    let axes = Matrix3::from_columns(&[ahead.into_inner(), left, up.into_inner()]);
    let world_from_camera = Rotation3::from_matrix_unchecked(axes.transpose());
    Isometry3::from_parts(
        Translation3::identity(),
        UnitQuaternion::from_rotation_matrix(&world_from_camera),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn world_of_a_camera_without_a_pose_is_upright() {
        for up in [
            -Vector3::y(),
            Vector3::new(0.0, -0.8, -0.6),
            Vector3::new(0.6, -0.5, 0.4),
            -Vector3::z(),
        ] {
            let up = UnitVector3::new_normalize(up);
            let pose = upright_world_from_camera(&up);
            assert!(
                (pose * up.into_inner() - Vector3::z()).norm() < 1e-12,
                "{up:?}"
            );
            let ahead = pose * Vector3::z();
            assert!(ahead.y.abs() < 1e-12 && ahead.x > -1e-12, "{ahead}");
        }
    }
}
