//! Points of an object view with the known camera geometry.

use crate::Error;
use crate::pcd::PcdCloud;
use crate::washington::{self, ObjectDataset};
use geometry::RigidTransform;
use nalgebra::{Point3, UnitVector3, Vector3};
use point_cloud::Point;

/// View of one object: its points and camera geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectView {
    /// Points of the view that are finite, in the unit of its file: metres in the Washington
    /// layout.
    pub points: Vec<Point>,
    /// Camera position in the frame and unit of the points, if known.
    pub viewpoint_m: Option<Point3<f64>>,
    /// Up direction in the frame of the points, if known.
    pub up: Option<UnitVector3<f64>>,
}

impl ObjectView {
    /// Reads a view in the Washington layout. Its points are in the frame of the camera, which
    /// looks down on the turntable.
    pub(super) fn of_washington(dataset: &ObjectDataset, index: usize) -> Result<Self, Error> {
        let sequence = dataset.name(index).map(washington::ViewName::sequence);
        Ok(Self {
            points: dataset.load_points(index)?,
            viewpoint_m: Some(Point3::origin()),
            up: sequence.and_then(elevation_deg).map(up_in_camera),
        })
    }

    /// Converts a PCD file. Its viewpoint counts as known unless it is the identity, which writers
    /// use when it is unknown. Its up direction is unknown.
    pub(super) fn of_pcd(cloud: PcdCloud) -> Self {
        let mut points = cloud.points;
        points.retain(Point::is_finite);
        let is_known = cloud.viewpoint != RigidTransform::identity();
        Self {
            points,
            viewpoint_m: is_known.then(|| cloud.viewpoint.translation.vector.into()),
            up: None,
        }
    }
}

/// Elevation of the camera of a sequence, degrees downwards (Lai et al. 2011).
pub(super) fn elevation_deg(sequence: u32) -> Option<f64> {
    match sequence {
        1 => Some(30.0),
        2 => Some(45.0),
        4 => Some(60.0),
        _ => None,
    }
}

/// Up direction of a level camera that looks down; x right, y down, z forward.
fn up_in_camera(elevation_deg: f64) -> UnitVector3<f64> {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    UnitVector3::new_normalize(Vector3::new(0.0, -cos, -sin))
}
