//! Contact points: places on the surface of an object at which a pad may press.

use nalgebra::{Point3, Vector3};

/// Evidence for a contact point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactEvidence {
    /// Point of a stored model in its estimated pose.
    Model,
    /// Measured surface.
    Seen,
    /// Occluding contour: the surface turns away from the camera there.
    Contour,
    /// Hidden surface, estimated by mirror symmetry.
    Mirrored,
}

/// Contact point of an object, frame of planning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Place, metres.
    pub position: Point3<f64>,
    /// Outward unit normal.
    pub normal: Vector3<f64>,
    /// Evidence for the point.
    pub evidence: ContactEvidence,
}
