//! Views: descriptor, pose, point cloud and capture data of an object at one instant.

use geometry::OrientedBox;
use learning::ViewId;

use crate::error::StoreRefusal;
use crate::label_status::{DecisionStamp, LabelStatus};

/// Maximum length of a descriptor, values. GOOD with fifty bins a side has 7500.
pub const MAX_DESCRIPTOR_VALUES: usize = 65_536;
/// Maximum size of a point cloud, bytes.
pub const MAX_POINTS_BYTES: usize = 16 << 20;
/// Maximum length of a descriptor kind, source or author name, bytes.
pub const MAX_NAME_BYTES: usize = 256;

/// Maximum deviation of the norm of a rotation quaternion from one. Chosen.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Descriptor values with their descriptor kind.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredDescriptor {
    /// Algorithm and parameters, such as `good-published-15`. Only descriptors of one kind are
    /// comparable.
    pub kind: String,
    /// Descriptor values, all finite, 1 to [`MAX_DESCRIPTOR_VALUES`].
    pub values: Vec<f32>,
}

/// View of an object; immutable once stored.
#[derive(Debug, Clone, PartialEq)]
pub struct CapturedView {
    /// Id of the view; its track-id must be leased.
    pub id: ViewId,
    /// Descriptor of the view.
    pub descriptor: StoredDescriptor,
    /// Oriented bounding box of the object in the world frame, metres.
    pub box_in_world: OrientedBox,
    /// Capture time of the view, nanoseconds since 1970, UTC.
    pub captured_ns: u64,
    /// Sequence number of the camera frame.
    pub frame_sequence: u64,
    /// Name of the camera or recording.
    pub source: String,
    /// Mean colour of the object: red, green, blue.
    pub mean_rgb: Option<[u8; 3]>,
    /// Packed point cloud of a key view, at most [`MAX_POINTS_BYTES`].
    pub points: Option<Vec<u8>>,
}

/// Provenance of a view: the memory that first stored it, and its id there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Origin {
    /// Id of the memory; for views learned from files, a digest of the files.
    pub memory_id: u128,
    /// Id of the view in its original memory.
    pub view: ViewId,
}

/// View with its label status, as stored.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredView {
    /// Captured view with its content.
    pub view: CapturedView,
    /// Memory that first stored the view, and the id of the view there.
    pub origin: Origin,
    /// Label status of the view.
    pub standing: LabelStatus,
    /// Author and time of the label status; `None` for a view that was never labelled.
    pub decided: Option<DecisionStamp>,
    /// Sequence number of the last history entry that touched the view.
    pub sequence: u64,
}

impl CapturedView {
    /// Size of descriptor and point cloud, bytes.
    pub(crate) fn n_large_bytes(&self) -> usize {
        let n_points_bytes = self.points.as_ref().map_or(0, Vec::len);
        size_of_val(&self.descriptor.values[..]) + n_points_bytes
    }

    /// Validates the values of the captured view.
    pub(crate) fn check(&self) -> Result<(), StoreRefusal> {
        let pose = &self.box_in_world.frame_from_box;
        let centre = &pose.translation.vector;
        let half_sides = &self.box_in_world.half_sides_m;
        let values = &self.descriptor.values;
        let too_long = |name: &str| name.len() > MAX_NAME_BYTES;
        let wrong = [
            (
                self.id.track_id == u64::MAX,
                "that track-id is never leased",
            ),
            (values.is_empty(), "its descriptor is empty"),
            (
                values.len() > MAX_DESCRIPTOR_VALUES,
                "its descriptor is too long",
            ),
            (
                !values.iter().all(|v| v.is_finite()),
                "its descriptor has a value that is not finite",
            ),
            (
                too_long(&self.descriptor.kind),
                "the name of its descriptor is too long",
            ),
            (too_long(&self.source), "the name of its source is too long"),
            (
                !centre.iter().all(|v| v.is_finite()),
                "the centre of its box is not finite",
            ),
            (
                !half_sides.iter().all(|v| v.is_finite() && *v >= 0.0),
                "a side of its box is not a length",
            ),
            (
                !is_unit(pose.rotation.quaternion().norm()),
                "the rotation of its box is not of unit length",
            ),
            (
                self.points
                    .as_ref()
                    .is_some_and(|points| points.len() > MAX_POINTS_BYTES),
                "its cloud is too large",
            ),
        ];
        match wrong.into_iter().find(|(is_wrong, _)| *is_wrong) {
            Some((_, reason)) => Err(StoreRefusal::InvalidView {
                view: self.id,
                reason,
            }),
            None => Ok(()),
        }
    }
}

/// `true` for a norm of one within the tolerance; `false` for NaN.
fn is_unit(norm: f64) -> bool {
    (norm - 1.0).abs() <= UNIT_TOLERANCE
}
