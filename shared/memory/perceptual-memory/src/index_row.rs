//! Index rows: one compact record for each view with all that the index in memory needs, so that
//! opening reads neither metadata nor history.

use std::sync::Arc;

use durable_leveldb::record::{seal, unseal};
use learning::ViewId;
use serde_bytes::ByteArray;

use crate::digest::Digest;
use crate::keys;
use crate::label_status::{DecisionStamp, LabelStatus, LwwRegister};
use crate::view::Origin;
use crate::view_record::{ContentRef, ViewMetadata};

/// View in the index with its properties.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct IndexedView {
    pub(crate) identity: Digest,
    pub(crate) descriptor: ContentRef,
    pub(crate) points: Option<ContentRef>,
    pub(crate) descriptor_kind: Arc<str>,
    pub(crate) captured_ns: u64,
    pub(crate) origin: Origin,
    pub(crate) register: LwwRegister,
}

/// Serialised form: a sequence without field names.
type PackedRow = (
    Digest,
    PackedRef,
    Option<PackedRef>,
    Arc<str>,
    u64,
    (ByteArray<16>, u64, u32),
    LabelStatus,
    (Arc<str>, u64),
    u64,
);
type PackedRef = (Digest, u32);

impl IndexedView {
    /// Row of a view with this metadata.
    pub(crate) fn of(metadata: &ViewMetadata, register: LwwRegister) -> Self {
        Self {
            identity: metadata.identity(),
            descriptor: metadata.descriptor,
            points: metadata.points,
            descriptor_kind: metadata.descriptor_kind.as_str().into(),
            captured_ns: metadata.captured_ns,
            origin: metadata.origin(),
            register,
        }
    }

    /// Size of descriptor and point cloud, bytes.
    pub(crate) fn n_bytes(&self) -> u64 {
        let points = self.points.map_or(0, |extent| extent.n_bytes);
        self.descriptor.n_bytes as u64 + points as u64
    }

    pub(crate) fn is_forgotten(&self) -> bool {
        self.register.standing == LabelStatus::Forgotten
    }

    /// `true` if the row belongs to a view with this metadata.
    pub(crate) fn matches(&self, metadata: &ViewMetadata) -> bool {
        Self::of(metadata, self.register.clone()) == *self
    }

    /// Serialised record of the row.
    pub(crate) fn seal(&self, view: ViewId) -> Vec<u8> {
        let packed_ref = |extent: ContentRef| (extent.digest, extent.n_bytes);
        let Origin {
            memory_id,
            view: origin,
        } = self.origin;
        let decided = &self.register.decided;
        let packed: PackedRow = (
            self.identity,
            packed_ref(self.descriptor),
            self.points.map(packed_ref),
            Arc::clone(&self.descriptor_kind),
            self.captured_ns,
            (
                ByteArray::new(memory_id.to_be_bytes()),
                origin.track_id,
                origin.view_id,
            ),
            self.register.standing.clone(),
            (Arc::clone(&decided.author), decided.stamp_ns),
            self.register.sequence,
        );
        seal(&keys::view_key(keys::ROW, view), &packed)
    }

    /// Deserialises the row under `key`.
    pub(crate) fn unseal(key: &[u8], record: &[u8]) -> Result<Self, &'static str> {
        let (
            identity,
            descriptor,
            points,
            descriptor_kind,
            captured_ns,
            origin,
            standing,
            by,
            sequence,
        ) = unseal::<PackedRow>(key, record)?;
        let (memory_id, track_id, view_id) = origin;
        let content_ref = |(digest, n_bytes): PackedRef| ContentRef { digest, n_bytes };
        let (author, stamp_ns) = by;
        Ok(Self {
            identity,
            descriptor: content_ref(descriptor),
            points: points.map(content_ref),
            descriptor_kind,
            captured_ns,
            origin: Origin {
                memory_id: u128::from_be_bytes(memory_id.into_array()),
                view: ViewId { track_id, view_id },
            },
            register: LwwRegister {
                standing,
                decided: DecisionStamp { author, stamp_ns },
                sequence,
            },
        })
    }
}
