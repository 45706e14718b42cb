//! View records: metadata under the view id; descriptor and point cloud under their content digests
//! (content-addressed, deduplicated, not read at opening).

use geometry::OrientedBox;
use learning::ViewId;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use serde_bytes::ByteArray;

use crate::digest::{Digest, Hasher};
use crate::view::{CapturedView, Origin, StoredDescriptor};

/// Domain separation of the identity digest from other digests and later formats.
const IDENTITY_PURPOSE: &[u8] = b"tabula view 2";

/// Oriented box as ten numbers: centre, rotation quaternion x, y, z, w, half sides.
pub(crate) type Box10 = [f64; 10];

/// Metadata record of a view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct ViewMetadata {
    box_in_world: Box10,
    pub(crate) captured_ns: u64,
    pub(crate) frame_sequence: u64,
    pub(crate) source: String,
    pub(crate) mean_rgb: Option<[u8; 3]>,
    /// Provenance of the view: memory id and view id.
    origin: (ByteArray<16>, ViewId),
    pub(crate) descriptor_kind: String,
    pub(crate) descriptor: ContentRef,
    pub(crate) points: Option<ContentRef>,
}

/// Content reference: digest and size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct ContentRef {
    pub(crate) digest: Digest,
    pub(crate) n_bytes: u32,
}

impl ContentRef {
    pub(crate) fn of(content: &[u8]) -> Self {
        Self {
            digest: Digest::of(content),
            n_bytes: content.len() as u32,
        }
    }
}

/// View split into its stored parts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ViewParts {
    pub(crate) metadata: ViewMetadata,
    /// Descriptor values as little-endian `f32`.
    pub(crate) descriptor: Vec<u8>,
    pub(crate) points: Option<Vec<u8>>,
}

impl ViewParts {
    pub(crate) fn of(view: &CapturedView, origin: Origin) -> Self {
        let values = view.descriptor.values.iter();
        let descriptor: Vec<u8> = values.flat_map(|value| value.to_le_bytes()).collect();
        Self {
            metadata: ViewMetadata {
                box_in_world: box_numbers(&view.box_in_world),
                captured_ns: view.captured_ns,
                frame_sequence: view.frame_sequence,
                source: view.source.clone(),
                mean_rgb: view.mean_rgb,
                origin: (ByteArray::new(origin.memory_id.to_be_bytes()), origin.view),
                descriptor_kind: view.descriptor.kind.clone(),
                descriptor: ContentRef::of(&descriptor),
                points: view.points.as_deref().map(ContentRef::of),
            },
            descriptor,
            points: view.points.clone(),
        }
    }

    /// `true` if descriptor and point cloud match their references in the metadata.
    pub(crate) fn is_what_it_says(&self) -> bool {
        ContentRef::of(&self.descriptor) == self.metadata.descriptor
            && self.points.as_deref().map(ContentRef::of) == self.metadata.points
    }

    /// `true` if the point cloud is present, or the view has none.
    pub(crate) fn are_complete(&self) -> bool {
        self.metadata.points.is_some() == self.points.is_some()
    }

    /// View assembled from its parts, under its local id.
    pub(crate) fn into_view(self, id: ViewId) -> CapturedView {
        CapturedView {
            id,
            descriptor: descriptor(self.metadata.descriptor_kind, &self.descriptor),
            box_in_world: box_of(self.metadata.box_in_world),
            captured_ns: self.metadata.captured_ns,
            frame_sequence: self.metadata.frame_sequence,
            source: self.metadata.source,
            mean_rgb: self.metadata.mean_rgb,
            points: self.points,
        }
    }
}

impl ViewMetadata {
    /// Metadata from a record of an older schema, which had no colour.
    pub(crate) fn from_parts(
        box_in_world: Box10,
        (captured_ns, frame_sequence, source): (u64, u64, String),
        origin: Origin,
        (descriptor_kind, descriptor): (String, ContentRef),
        points: Option<ContentRef>,
    ) -> Self {
        Self {
            box_in_world,
            captured_ns,
            frame_sequence,
            source,
            mean_rgb: None,
            origin: (ByteArray::new(origin.memory_id.to_be_bytes()), origin.view),
            descriptor_kind,
            descriptor,
            points,
        }
    }

    pub(crate) fn box_in_world(&self) -> OrientedBox {
        box_of(self.box_in_world)
    }

    pub(crate) fn origin(&self) -> Origin {
        Origin {
            memory_id: u128::from_be_bytes(self.origin.0.into_array()),
            view: self.origin.1,
        }
    }

    /// Content digest of the view, equal on every robot: covers everything except the local id. The
    /// fields are hashed one by one, so that it does not depend on the record format.
    pub(crate) fn identity(&self) -> Digest {
        let mut hasher = Hasher::new(IDENTITY_PURPOSE);
        for number in self.box_in_world {
            hasher = hasher.update(&number.to_bits().to_le_bytes());
        }
        let ViewId { track_id, view_id } = self.origin.1;
        hasher = hasher
            .update(&self.captured_ns.to_le_bytes())
            .update(&self.frame_sequence.to_le_bytes())
            .update_text(&self.source)
            .update_text(&self.descriptor_kind)
            .update(&[u8::from(self.mean_rgb.is_some())])
            .update(&self.mean_rgb.unwrap_or_default())
            .update(&*self.origin.0)
            .update(&track_id.to_le_bytes())
            .update(&view_id.to_le_bytes())
            .update(&self.descriptor.digest.0.to_le_bytes());
        if let Some(points) = &self.points {
            hasher = hasher.update(&points.digest.0.to_le_bytes());
        }
        hasher.finish()
    }
}

/// Descriptor from its stored values: little-endian `f32`. The format on disk is this
/// crate's own and changes only with the schema, unlike the one on the wire
/// (`message::DescriptorBytes`); a remainder of less than four bytes is ignored, so that every
/// record stays readable.
pub(crate) fn descriptor(kind: String, values: &[u8]) -> StoredDescriptor {
    let (values, _) = values.as_chunks::<4>();
    StoredDescriptor {
        kind,
        values: values
            .iter()
            .map(|value| f32::from_le_bytes(*value))
            .collect(),
    }
}

fn box_numbers(box_in_world: &OrientedBox) -> Box10 {
    let pose = &box_in_world.frame_from_box;
    let mut numbers = [0.0; 10];
    numbers[..3].copy_from_slice(pose.translation.vector.as_slice());
    numbers[3..7].copy_from_slice(pose.rotation.coords.as_slice());
    numbers[7..].copy_from_slice(box_in_world.half_sides_m.as_slice());
    numbers
}

/// Box with exactly the stored bits, which were validated before they were stored.
fn box_of(numbers: Box10) -> OrientedBox {
    let [cx, cy, cz, qx, qy, qz, qw, hx, hy, hz] = numbers;
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(qw, qx, qy, qz));
    OrientedBox {
        frame_from_box: Isometry3::from_parts(Translation3::new(cx, cy, cz), rotation),
        half_sides_m: Vector3::new(hx, hy, hz),
    }
}
