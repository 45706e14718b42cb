//! A view as it is stored: the small part apart from descriptor and cloud, which
//! lie under the digests of their content, so that equal ones are stored once and
//! opening the store need not read them.

use geometry::OrientedBox;
use learning::ViewId;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use serde_bytes::ByteArray;

use crate::digest::{Digest, Hasher};
use crate::view::{Descriptor, Origin, View};

/// Keeps identities apart from other digests, and from those of later formats.
const IDENTITY_PURPOSE: &[u8] = b"tabula view 2";

/// Centre, rotation as x, y, z, w, half sides.
pub(crate) type Box10 = [f64; 10];

/// The small part of a view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Facts {
    box_in_world: Box10,
    pub(crate) captured_ns: u64,
    pub(crate) frame_sequence: u64,
    pub(crate) source: String,
    pub(crate) mean_rgb: Option<[u8; 3]>,
    /// Memory and view.
    origin: (ByteArray<16>, ViewId),
    pub(crate) descriptor_kind: String,
    pub(crate) descriptor: Extent,
    pub(crate) points: Option<Extent>,
}

/// Digest and size of content.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Extent {
    pub(crate) digest: Digest,
    pub(crate) n_bytes: u32,
}

impl Extent {
    pub(crate) fn of(content: &[u8]) -> Self {
        Self {
            digest: Digest::of(content),
            n_bytes: content.len() as u32,
        }
    }
}

/// A view in the parts in which it is stored.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ViewParts {
    pub(crate) facts: Facts,
    /// Little-endian `f32`.
    pub(crate) descriptor: Vec<u8>,
    pub(crate) points: Option<Vec<u8>>,
}

impl ViewParts {
    pub(crate) fn of(view: &View, origin: Origin) -> Self {
        let values = view.descriptor.values.iter();
        let descriptor: Vec<u8> = values.flat_map(|value| value.to_le_bytes()).collect();
        Self {
            facts: Facts {
                box_in_world: box_numbers(&view.box_in_world),
                captured_ns: view.captured_ns,
                frame_sequence: view.frame_sequence,
                source: view.source.clone(),
                mean_rgb: view.mean_rgb,
                origin: (ByteArray::new(origin.memory_id.to_be_bytes()), origin.view),
                descriptor_kind: view.descriptor.kind.clone(),
                descriptor: Extent::of(&descriptor),
                points: view.points.as_deref().map(Extent::of),
            },
            descriptor,
            points: view.points.clone(),
        }
    }

    /// Whether descriptor and cloud are what the facts say.
    pub(crate) fn is_what_it_says(&self) -> bool {
        Extent::of(&self.descriptor) == self.facts.descriptor
            && self.points.as_deref().map(Extent::of) == self.facts.points
    }

    /// Whether its cloud is there, if it has one.
    pub(crate) fn are_complete(&self) -> bool {
        self.facts.points.is_some() == self.points.is_some()
    }

    /// The view these parts make, under the id it has here.
    pub(crate) fn into_view(self, id: ViewId) -> View {
        View {
            id,
            descriptor: descriptor(self.facts.descriptor_kind, &self.descriptor),
            box_in_world: box_of(self.facts.box_in_world),
            captured_ns: self.facts.captured_ns,
            frame_sequence: self.facts.frame_sequence,
            source: self.facts.source,
            mean_rgb: self.facts.mean_rgb,
            points: self.points,
        }
    }
}

impl Facts {
    /// From a record of an older schema, which knew no colour.
    pub(crate) fn from_parts(
        box_in_world: Box10,
        (captured_ns, frame_sequence, source): (u64, u64, String),
        origin: Origin,
        (descriptor_kind, descriptor): (String, Extent),
        points: Option<Extent>,
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

    /// What the view is known by on every robot: a digest of everything in it but
    /// the id it has here. Spelled out, so that it does not depend on how the
    /// record is written.
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

/// A descriptor from its stored values.
pub(crate) fn descriptor(kind: String, values: &[u8]) -> Descriptor {
    let (values, _) = values.as_chunks::<4>();
    Descriptor {
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

/// The box with the very bits that were stored; they were checked then.
fn box_of(numbers: Box10) -> OrientedBox {
    let [cx, cy, cz, qx, qy, qz, qw, hx, hy, hz] = numbers;
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(qw, qx, qy, qz));
    OrientedBox {
        frame_from_box: Isometry3::from_parts(Translation3::new(cx, cy, cz), rotation),
        half_sides_m: Vector3::new(hx, hy, hz),
    }
}
