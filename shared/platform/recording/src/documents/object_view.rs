//! Document of a described view of an object.

use super::{CategoryDocument, pose, session};
use crate::document::document;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use message::ObjectViewHeader;

document! {
    /// Described view of a tracked object.
    ObjectViewDocument = "tabula.ObjectView" {
        /// Session of the camera.
        session: String,
        /// Sequence number of the frame.
        sequence: u64,
        /// Capture time of the frame, nanoseconds.
        capture_ns: u64,
        /// Track-id of the object.
        track_id: u64,
        /// Number of the view within the track, from 0.
        view_id: u32,
        /// True for a key view, which goes to the perceptual memory.
        is_key_view: bool,
        /// Number of key views of the track so far.
        n_key_views: u32,
        /// Number of points of the view.
        n_points: u32,
        /// Pose of the box, world frame: position in metres, then quaternion x, y, z, w.
        pose: [f64; 7],
        /// Side lengths of the box, metres.
        size_m: [f32; 3],
        /// Distance to the nearest stored view; null when nothing is stored.
        distance: f32,
        /// Most probable categories, best first.
        categories: Vec<CategoryDocument>,
        /// Descriptor: 32-bit floating-point numbers, little-endian, in Base64.
        descriptor_base64: String,
    }
}

impl ObjectViewDocument {
    /// Document of a view and its descriptor.
    pub fn new(view: &ObjectViewHeader, descriptor: &[f32]) -> Self {
        let bytes: Vec<u8> = descriptor.iter().flat_map(|v| v.to_le_bytes()).collect();
        let categories = view.categories();
        Self {
            session: session(view.session),
            sequence: view.sequence,
            capture_ns: view.capture_ns,
            track_id: view.track_id,
            view_id: view.view_id,
            is_key_view: view.is_key_view == 1,
            n_key_views: view.n_key_views,
            n_points: view.n_points,
            pose: pose(&view.pose),
            size_m: view.size_m,
            distance: view.distance,
            categories: categories
                .map(|(category, distance, probability)| CategoryDocument {
                    category: category.into(),
                    distance,
                    probability,
                })
                .collect(),
            descriptor_base64: STANDARD.encode(bytes),
        }
    }
}
