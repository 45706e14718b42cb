//! Stored views: what is known of a track at one moment it was seen.

use geometry::OrientedBox;
use learning::{CategoryName, ViewChange, ViewId};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::error::Refusal;
use crate::history::HistoryEntry;

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
    /// Packed points of a key view's cloud, at most [`MAX_POINTS_BYTES`].
    pub points: Option<Vec<u8>>,
}

/// The name a view carries, and where it comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// The name.
    pub category: CategoryName,
    /// Who gave it.
    pub author: String,
    /// When, nanoseconds since 1970, UTC.
    pub wall_ns: u64,
    /// Sequence of the history entry that gave it.
    pub sequence: u64,
}

/// A view as it is in the store.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredView {
    /// What was stored.
    pub view: View,
    /// Its name, if it has one.
    pub label: Option<Label>,
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

/// The small part of a view as it is stored; the large parts have tables of
/// their own, so that opening the store need not read them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Facts {
    /// Centre, rotation as x, y, z, w, half sides.
    box_in_world: [f64; 10],
    captured_ns: u64,
    frame_sequence: u64,
    source: String,
    pub(crate) descriptor: Extent,
    pub(crate) points: Option<Extent>,
}

/// Size and checksum of a large part: which content belongs to these facts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Extent {
    pub(crate) n_bytes: u32,
    pub(crate) crc32: u32,
}

impl Extent {
    pub(crate) fn of(record: &[u8]) -> Self {
        Self {
            n_bytes: record.len() as u32,
            crc32: crc32fast::hash(record),
        }
    }
}

/// A descriptor as it is stored.
#[derive(Serialize, Deserialize)]
pub(crate) struct PackedDescriptor {
    kind: String,
    /// Little-endian `f32`.
    #[serde(with = "serde_bytes")]
    values: Vec<u8>,
}

/// A label as it is stored; a view that lost its name keeps the record without one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct PackedLabel {
    pub(crate) category: Option<String>,
    pub(crate) author: String,
    pub(crate) wall_ns: u64,
    pub(crate) sequence: u64,
}

impl PackedLabel {
    /// What an entry of the history makes of a view's label.
    pub(crate) fn given_by(entry: &HistoryEntry, change: &ViewChange) -> Self {
        Self {
            category: change.after.as_ref().map(|name| name.as_str().to_owned()),
            author: entry.author.clone(),
            wall_ns: entry.wall_ns,
            sequence: entry.sequence,
        }
    }
}

impl Facts {
    pub(crate) fn of(view: &View, descriptor: Extent, points: Option<Extent>) -> Self {
        let pose = &view.box_in_world.frame_from_box;
        let mut numbers = [0.0; 10];
        numbers[..3].copy_from_slice(pose.translation.vector.as_slice());
        numbers[3..7].copy_from_slice(pose.rotation.coords.as_slice());
        numbers[7..].copy_from_slice(view.box_in_world.half_sides_m.as_slice());
        Self {
            box_in_world: numbers,
            captured_ns: view.captured_ns,
            frame_sequence: view.frame_sequence,
            source: view.source.clone(),
            descriptor,
            points,
        }
    }

    /// The view these facts and its large parts make.
    pub(crate) fn into_view(
        self,
        id: ViewId,
        descriptor: Descriptor,
        points: Option<Vec<u8>>,
    ) -> View {
        let [cx, cy, cz, qx, qy, qz, qw, hx, hy, hz] = self.box_in_world;
        // Unchecked, so that the very bits come back; they were checked when stored.
        let rotation = UnitQuaternion::new_unchecked(Quaternion::new(qw, qx, qy, qz));
        View {
            id,
            descriptor,
            box_in_world: OrientedBox {
                frame_from_box: Isometry3::from_parts(Translation3::new(cx, cy, cz), rotation),
                half_sides_m: Vector3::new(hx, hy, hz),
            },
            captured_ns: self.captured_ns,
            frame_sequence: self.frame_sequence,
            source: self.source,
            points,
        }
    }
}

impl From<&Descriptor> for PackedDescriptor {
    fn from(descriptor: &Descriptor) -> Self {
        let values = descriptor
            .values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        Self {
            kind: descriptor.kind.clone(),
            values,
        }
    }
}

impl From<PackedDescriptor> for Descriptor {
    fn from(packed: PackedDescriptor) -> Self {
        let (values, _) = packed.values.as_chunks::<4>();
        let values = values
            .iter()
            .map(|value| f32::from_le_bytes(*value))
            .collect();
        Self {
            kind: packed.kind,
            values,
        }
    }
}
