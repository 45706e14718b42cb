//! Document of a stored object model.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Full model of an object, without its surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelDocument {
    /// Name of the model.
    pub name: String,
    /// Size of the stored model, bytes.
    pub bytes: u64,
    /// Author of the model.
    pub author: String,
    /// Time at which the model was stored, nanoseconds since 1970.
    pub decided_ns: u64,
    /// History sequence number of the model.
    pub sequence: u64,
    /// Extents of the model along its axes, metres.
    pub extents_m: [f64; 3],
    /// Number of vertices of the surface.
    pub n_vertices: usize,
    /// Number of triangles of the surface.
    pub n_triangles: usize,
    /// True if the views go around the object and meet.
    pub is_closed_loop: bool,
    /// Share of all directions from which the object was seen, 0 to 1.
    pub completeness: f64,
    /// Parts that no view shows, in words.
    pub missing: Vec<String>,
    /// Directions from which the object was not seen, unit vectors in the model's frame.
    pub unseen_directions: Vec<[f32; 3]>,
    /// Views that the model is made of.
    pub views: Vec<ModelViewDocument>,
    /// Views that were refused.
    pub refused: Vec<RefusedViewDocument>,
}

/// View that was fused into a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelViewDocument {
    /// Capture time of the view, nanoseconds.
    pub captured_ns: u64,
    /// Number of measured points of the view.
    pub n_points: u32,
    /// Share of the view's surface that no earlier view had shown, 0 to 1.
    pub new_surface_share: f32,
    /// Position of the camera in the model's frame, metres.
    pub position_m: [f64; 3],
    /// Orientation of the camera in the model's frame, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
}

/// View that was not fused into a model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct RefusedViewDocument {
    /// Capture time of the view, nanoseconds.
    pub captured_ns: u64,
    /// Reason of the refusal.
    pub reason: String,
}
