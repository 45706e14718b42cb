//! Stored views: what is known of a track at one moment it was seen.

use geometry::OrientedBox;
use learning::ViewId;

use crate::error::Refusal;
use crate::standing::{Decided, Standing};

/// Longest descriptor, numbers; GOOD with fifty bins a side has 7 500.
pub const MAX_DESCRIPTOR_VALUES: usize = 65_536;
/// Largest cloud of one view, bytes.
pub const MAX_POINTS_BYTES: usize = 16 << 20;
/// Longest name of a descriptor's kind, of a source, and of an author, bytes.
pub const MAX_NAME_BYTES: usize = 256;

/// How far a rotation's norm may be from one.
const UNIT_TOLERANCE: f64 = 1e-6;

/// A shape descriptor with the name of how it was computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Descriptor {
    /// Descriptor and parameters, such as `good-published-15`. Only descriptors
    /// of one kind can be compared.
    pub kind: String,
    /// Its values, all finite, 1 to [`MAX_DESCRIPTOR_VALUES`].
    pub values: Vec<f32>,
}

/// A view to be stored, or as it was stored; it never changes.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Which view; its track-id is below `u64::MAX`.
    pub id: ViewId,
    /// Its descriptor.
    pub descriptor: Descriptor,
    /// The object's box in the world frame, metres.
    pub box_in_world: OrientedBox,
    /// When it was captured, nanoseconds since 1970, UTC.
    pub captured_ns: u64,
    /// Number of the frame it was seen in.
    pub frame_sequence: u64,
    /// Name of the camera or recording.
    pub source: String,
    /// Mean colour: red, green, blue.
    pub mean_rgb: Option<[u8; 3]>,
    /// Packed points of a key view's cloud, at most [`MAX_POINTS_BYTES`].
    pub points: Option<Vec<u8>>,
}

/// Where a view was first stored: which robot's memory, and which view it was there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Origin {
    /// The memory; for views learned from files, a digest of which files.
    pub memory_id: u128,
    /// The view there.
    pub view: ViewId,
}

/// A view as it is in the store.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredView {
    /// What was stored.
    pub view: View,
    /// Where it was first stored.
    pub origin: Origin,
    /// What it stands for.
    pub standing: Standing,
    /// Who decided that; nobody yet when it was never named.
    pub decided: Option<Decided>,
    /// Sequence of the history entry that touched it last.
    pub sequence: u64,
}

impl View {
    /// Bytes of its descriptor and cloud.
    pub(crate) fn n_large_bytes(&self) -> usize {
        let n_points_bytes = self.points.as_ref().map_or(0, Vec::len);
        size_of_val(&self.descriptor.values[..]) + n_points_bytes
    }

    /// Refuses what could not be read back or recognised against.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
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
            Some((_, reason)) => Err(Refusal::InvalidView {
                view: self.id,
                reason,
            }),
            None => Ok(()),
        }
    }
}

/// False for NaN.
fn is_unit(norm: f64) -> bool {
    (norm - 1.0).abs() <= UNIT_TOLERANCE
}
