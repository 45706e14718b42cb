//! Full model of an object: surface, views, and what is still missing.

use crate::unseen_directions::UnseenDirections;
use geometry::RigidTransform;
use point_cloud::Vertex;

/// Full model of an object, fused from views of it.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectModel {
    /// Coloured surface in the frame of the object, metres.
    pub mesh: ModelMesh,
    /// Views that the surface is fused from, in the order in which they were added.
    pub views: Vec<ModelView>,
    /// Views that were not fused.
    pub refused: Vec<RefusedView>,
    /// True if the views close a loop around the object, so that drift was spread over them.
    pub is_closed_loop: bool,
    /// Directions from which the surface was never seen.
    pub unseen: UnseenDirections,
}

/// Coloured surface of a model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModelMesh {
    /// Vertices with outward unit normals and sRGB colours; coordinates of at most
    /// [`MAX_COORDINATE_M`](crate::MAX_COORDINATE_M), metres.
    pub vertices: Vec<Vertex>,
    /// Corner indices of each triangle into the vertices, counter-clockwise seen from outside;
    /// empty for a model without faces.
    pub triangles: Vec<[u32; 3]>,
}

/// View that was fused into a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelView {
    /// Pose of the camera in the frame of the object.
    pub object_from_camera: RigidTransform,
    /// Capture time, nanoseconds since 1970.
    pub captured_ns: u64,
    /// Number of points of the object in the view.
    pub n_points: u32,
    /// Share of the view's surface that no earlier view had shown, 0 to 1.
    pub new_surface_share: f32,
}

/// View that was not fused into a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RefusedView {
    /// Capture time, nanoseconds since 1970.
    pub captured_ns: u64,
    /// Reason in words, one line of at most
    /// [`MAX_REASON_BYTES`](crate::MAX_REASON_BYTES).
    pub reason: String,
}
