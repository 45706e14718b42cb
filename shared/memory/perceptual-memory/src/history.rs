//! Hash-chained history: numbered entries, each with the digest of its predecessor, so that loss,
//! alteration and insertion are detected.
//!
//! An entry records the request and all its effects (event sourcing). The content of the store is
//! the result of applying all entries to an empty store; see [`crate::replay`].

use std::collections::BTreeSet;
use std::sync::Arc;

use durable_leveldb::{
    MutationId,
    record::{seal, unseal},
};
use learning::ViewId;
use serde::{Deserialize, Serialize};
use serde_bytes::ByteArray;

use crate::digest::{Digest, Hasher};
use crate::keys;
use crate::label_status::DecisionStamp;
use crate::model::{Contradiction, Effect, MutationReceipt, Operation};

/// Entry of the store's history.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HistoryEntry {
    /// Sequence number of the entry, from one.
    pub sequence: u64,
    /// Hash chain: digest of the preceding entry; zero for the first.
    pub previous: Digest,
    /// Time of the request, nanoseconds since 1970, UTC.
    pub wall_ns: u64,
    /// Author of the request, as the client claims.
    pub author: Arc<str>,
    /// User id of the client, as the kernel says; `None` for entries that the store writes itself
    /// and for those of versions that did not record it.
    pub uid: Option<u32>,
    /// Requested operation.
    pub operation: Operation,
    /// Idempotency key of the mutation; `None` for entries that the store writes itself.
    pub mutation: Option<MutationId>,
    /// Effects of the operation on the store.
    pub effects: Vec<Effect>,
    /// Contradicted label, if the entry has no effect for that reason.
    pub contradiction: Option<Contradiction>,
}

/// Serialised form of an entry; its sequence number is in the key.
#[derive(Serialize, Deserialize)]
struct Packed {
    previous: Digest,
    wall_ns: u64,
    author: Arc<str>,
    operation: Operation,
    mutation: Option<ByteArray<16>>,
    effects: Vec<Effect>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    uid: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    contradiction: Option<Contradiction>,
}

impl HistoryEntry {
    /// Serialised record and digest of the entry.
    pub(crate) fn seal(&self) -> (Vec<u8>, Digest) {
        let packed = Packed {
            previous: self.previous,
            wall_ns: self.wall_ns,
            author: Arc::clone(&self.author),
            operation: self.operation.clone(),
            mutation: self.mutation.map(|id| ByteArray::new(id.0.to_be_bytes())),
            effects: self.effects.clone(),
            uid: self.uid,
            contradiction: self.contradiction.clone(),
        };
        let record = seal(&keys::history_key(self.sequence), &packed);
        let digest = Self::digest_of(self.sequence, &record);
        (record, digest)
    }

    /// Deserialises an entry and computes its digest.
    pub(crate) fn unseal(sequence: u64, record: &[u8]) -> Result<(Self, Digest), &'static str> {
        let packed: Packed = unseal(&keys::history_key(sequence), record)?;
        let mutation = packed
            .mutation
            .map(|id| u128::from_be_bytes(id.into_array()));
        let entry = Self {
            sequence,
            previous: packed.previous,
            wall_ns: packed.wall_ns,
            author: packed.author,
            uid: packed.uid,
            operation: packed.operation,
            mutation: mutation.map(MutationId),
            effects: packed.effects,
            contradiction: packed.contradiction,
        };
        Ok((entry, Self::digest_of(sequence, record)))
    }

    /// Digest by which the next entry refers to this one.
    fn digest_of(sequence: u64, record: &[u8]) -> Digest {
        Hasher::new(b"tabula history 2")
            .update(&sequence.to_le_bytes())
            .update(record)
            .finish()
    }

    /// Stamp of a decision by the entry's author, later than the stamp that it replaces.
    pub(crate) fn decided_after(&self, last_stamp_ns: u64) -> DecisionStamp {
        DecisionStamp::after(last_stamp_ns, Arc::clone(&self.author), self.wall_ns)
    }

    /// Receipt for the mutation that made the entry.
    pub(crate) fn answer(&self) -> MutationReceipt {
        // An import may change only the time stamp of a decision.
        let is_change = |effect: &&Effect| !matches!(effect, Effect::Changed { before, after, .. } if before == after);
        let changes = self.effects.iter().filter(is_change);
        let views: BTreeSet<ViewId> = changes.filter_map(Effect::view).collect();
        MutationReceipt {
            sequence: self.sequence,
            n_views: views.len() as u64,
            contradiction: self.contradiction.clone(),
        }
    }
}
