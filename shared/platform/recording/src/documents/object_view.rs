//! Document of a described view of an object.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use message::ObjectViewHeader;
use message::document::{near_categories, rounded};
use scene_document::{Document, NearCategoryDocument};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Described view of a tracked object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ObjectViewDocument {
    /// Session of the camera.
    pub session: String,
    /// Sequence number of the frame.
    pub frame_sequence: u64,
    /// Capture time of the frame, nanoseconds.
    pub capture_stamp_ns: u64,
    /// Track-id of the object.
    pub track_id: u64,
    /// Number of the view within the track, from 0.
    pub view_id: u32,
    /// True for a key view, which goes to the perceptual memory.
    pub is_key_view: bool,
    /// Number of key views of the track so far.
    pub n_key_views: u32,
    /// Number of points of the view.
    pub n_points: u32,
    /// Centre of the box in the world, metres.
    pub position_m: [f64; 3],
    /// Orientation of the box in the world, quaternion: x, y, z, w.
    pub orientation_xyzw: [f64; 4],
    /// Side lengths of the box, metres.
    pub size_m: [f64; 3],
    /// Distance to the nearest stored view; null when nothing is stored.
    pub distance: Option<f64>,
    /// Most probable categories, best first.
    pub categories: Vec<NearCategoryDocument>,
    /// Descriptor: 32-bit floating-point numbers, little-endian, in Base64.
    pub descriptor_base64: String,
}

impl ObjectViewDocument {
    /// Document of a view and its descriptor.
    pub fn new(view: &ObjectViewHeader, descriptor: &[f32]) -> Self {
        let bytes: Vec<u8> = descriptor.iter().flat_map(|v| v.to_le_bytes()).collect();
        Self {
            session: view.session.to_string(),
            frame_sequence: view.sequence,
            capture_stamp_ns: view.capture_ns,
            track_id: view.track_id,
            view_id: view.view_id,
            is_key_view: view.is_key_view == 1,
            n_key_views: view.n_key_views,
            n_points: view.n_points,
            position_m: view.pose.position_m,
            orientation_xyzw: view.pose.orientation_xyzw,
            size_m: view.size_m.map(rounded),
            distance: view.distance.is_finite().then(|| rounded(view.distance)),
            categories: near_categories(view.categories()),
            descriptor_base64: STANDARD.encode(bytes),
        }
    }
}

impl Document for ObjectViewDocument {
    const NAME: &'static str = "tabula.ObjectView";
}
