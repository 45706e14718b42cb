//! Snapshot of the table: one frame with its scene and the measured points of the seen objects.

use geometry::{PinholeCamera, Plane, RigidTransform};
use message::TrackState;
use nalgebra::{Point3, Unit, Vector3};
use point_cloud::Point;

/// Frame with its scene. Places are in the world, or, where the camera's pose is unknown, in the
/// frame of the camera.
#[derive(Debug, Clone)]
pub(crate) struct Snapshot {
    /// Points of the frame, row-major, camera frame.
    pub(crate) points: Vec<Point>,
    pub(crate) camera: PinholeCamera,
    /// Pose of the camera; `None` when it is unknown.
    pub(crate) world_from_camera: Option<RigidTransform>,
    /// Direction against gravity in the camera frame, as the camera measures it.
    pub(crate) up_in_camera: Option<Unit<Vector3<f64>>>,
    pub(crate) table_in_world: Option<Plane>,
    /// Tracked objects, by track-id; tentative ones are left out.
    pub(crate) objects: Vec<SnapshotObject>,
    pub(crate) session: u64,
    pub(crate) sequence: u64,
    /// Capture time, nanoseconds of the camera's clock.
    pub(crate) capture_ns: u64,
    pub(crate) source_name: String,
}

/// Tracked object of a snapshot.
#[derive(Debug, Clone)]
pub(crate) struct SnapshotObject {
    pub(crate) track: u64,
    pub(crate) label: Option<String>,
    pub(crate) state: TrackState,
    /// Middle of its box.
    pub(crate) middle_in_world: Point3<f64>,
    /// Measured points, camera frame, metres; empty for an object that is not seen.
    pub(crate) points: Vec<[f32; 3]>,
}

impl Snapshot {
    /// Pose of the camera in the frame of all places: the identity when it is unknown.
    pub(crate) fn pose(&self) -> RigidTransform {
        self.world_from_camera.unwrap_or_default()
    }

    /// Points of the frame with depth.
    pub(crate) fn measured(&self) -> impl Iterator<Item = &Point> {
        self.points.iter().filter(|point| point.is_finite())
    }

    /// Snapshot of points that nothing else is known of.
    #[cfg(test)]
    pub(crate) fn of_points(camera: PinholeCamera, points: Vec<Point>) -> Self {
        Self {
            points,
            camera,
            world_from_camera: None,
            up_in_camera: None,
            table_in_world: None,
            objects: Vec::new(),
            session: 1,
            sequence: 1,
            capture_ns: 0,
            source_name: String::new(),
        }
    }
}
