//! Hash-chained history: numbered entries, each with the digest of its predecessor, so that loss,
//! alteration and insertion are detected.
//!
//! An entry records the request and all its effects (event sourcing). The content of the store is
//! the result of applying all entries to an empty store; see [`crate::replay`].

use std::collections::BTreeSet;
use std::sync::Arc;

use learning::{CategoryName, ViewId};
use serde::{Deserialize, Serialize};
use serde_bytes::ByteArray;

use crate::digest::{Digest, Hasher};
use crate::document::{DocumentContent, DocumentKey};
use crate::keys;
use crate::label_status::{Decided, Standing};
use crate::mutation::{Answer, MutationId, Target};
use crate::record::{seal, unseal};
use crate::salvage::DataLoss;

/// Requested operation of a history entry.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Operation {
    /// Storing of views.
    StoreViews,
    /// Labelling of a track.
    Teach {
        /// Track.
        track_id: u64,
        /// Category label.
        category: CategoryName,
    },
    /// Relabelling of a track or view.
    Correct {
        /// Relabelled views.
        target: Target,
        /// Category label.
        category: CategoryName,
    },
    /// Removal of a label, or forgetting of views.
    Forget {
        /// Forgotten category, track or view.
        target: Target,
    },
    /// Renaming of a category.
    Rename {
        /// Old name.
        from: CategoryName,
        /// New name.
        to: CategoryName,
    },
    /// Merge of two categories.
    MergeCategories {
        /// Dissolved category.
        from: CategoryName,
        /// Category that received the views.
        into: CategoryName,
    },
    /// Undo of an earlier entry.
    Undo {
        /// Sequence number of the undone entry.
        sequence: u64,
    },
    /// Import of a part of another memory.
    Import {
        /// Name of the source, as the requester gave it.
        source: String,
    },
    /// Storing of a document.
    PutDocument {
        /// Key of the document.
        document: DocumentKey,
    },
    /// Removal of a document.
    RemoveDocument {
        /// Key of the document.
        document: DocumentKey,
    },
    /// Permanent deletion of forgotten or replaced content.
    Purge,
    /// Enforcement of a retention limit: views of a category were forgotten, or unlabelled views
    /// were deleted.
    #[serde(rename = "economise")]
    EnforceLimit {
        /// Category; `None` for unlabelled views.
        category: Option<CategoryName>,
    },
    /// Rebuild of a damaged store from its intact records.
    Rebuild {
        /// Losses of the rebuild.
        loss: DataLoss,
        /// First and last sequence numbers of each range of lost entries.
        lost: Vec<(u64, u64)>,
    },
    /// Migration from an older schema.
    Migrate {
        /// Schema version before the migration.
        schema: u32,
    },
}

/// Single effect of a history entry.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Effect {
    /// Insertion of a view, without a label.
    #[serde(rename = "s")]
    Stored {
        /// Id of the view in this store.
        #[serde(rename = "v")]
        view: ViewId,
        /// Content digest of the view.
        #[serde(rename = "i")]
        identity: Digest,
    },
    /// Change of the label status of a view.
    #[serde(rename = "c")]
    Changed {
        /// Id of the view.
        #[serde(rename = "v")]
        view: ViewId,
        /// Label status before.
        #[serde(rename = "b")]
        before: Standing,
        /// Label status after.
        #[serde(rename = "a")]
        after: Standing,
        /// Author and time of the decision, if they differ from those of the entry.
        #[serde(rename = "d", default, skip_serializing_if = "Option::is_none")]
        decided: Option<Decided>,
    },
    /// Permanent deletion of a view.
    #[serde(rename = "p")]
    Purged {
        /// Id of the view.
        #[serde(rename = "v")]
        view: ViewId,
    },
    /// Tombstone of a forgotten view that is not stored: set or cleared.
    #[serde(rename = "t")]
    Tombstone {
        /// Content digest of the view.
        #[serde(rename = "i")]
        identity: Digest,
        /// Author and time of the forgetting; `None` clears the tombstone.
        #[serde(rename = "d")]
        decided: Option<Decided>,
    },
    /// Replacement of the content of a document.
    #[serde(rename = "d")]
    Document {
        /// Key of the document.
        #[serde(rename = "k")]
        document: DocumentKey,
        /// Content before.
        #[serde(rename = "b")]
        before: Option<DocumentContent>,
        /// Content after.
        #[serde(rename = "a")]
        after: Option<DocumentContent>,
        /// Author and time of the decision, if they differ from those of the entry.
        #[serde(rename = "w", default, skip_serializing_if = "Option::is_none")]
        decided: Option<Decided>,
    },
    /// Permanent deletion of an earlier version of a document.
    #[serde(rename = "q")]
    VersionPurged {
        /// Key of the document.
        #[serde(rename = "k")]
        document: DocumentKey,
        /// Sequence number of the entry that stored the version.
        #[serde(rename = "n")]
        sequence: u64,
    },
}

impl Effect {
    /// Id of the affected view, if any.
    pub fn view(&self) -> Option<ViewId> {
        match self {
            Self::Stored { view, .. } | Self::Changed { view, .. } | Self::Purged { view } => {
                Some(*view)
            }
            _ => None,
        }
    }
}

/// `true` if a sequence number lies in one of the inclusive ranges.
pub(crate) fn is_among(ranges: &[(u64, u64)], sequence: u64) -> bool {
    let mut ranges = ranges.iter();
    ranges.any(|(first, last)| (*first..=*last).contains(&sequence))
}

/// Conflict of a teaching request with the present label of the track.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Contradiction {
    /// Present label of the track.
    pub present: CategoryName,
    /// Author and time of the present label.
    pub decided: Decided,
}

/// Entry of the history.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HistoryEntry {
    /// Sequence number, from one.
    pub sequence: u64,
    /// Digest of the preceding entry; zero for the first.
    pub previous: Digest,
    /// Time of the request, nanoseconds since 1970, UTC.
    pub wall_ns: u64,
    /// Author of the request.
    pub author: Arc<str>,
    /// Requested operation.
    pub operation: Operation,
    /// Idempotency key of the mutation; `None` for entries that the store writes itself.
    pub mutation: Option<MutationId>,
    /// Effects on the store.
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

    /// Answer to the mutation that made the entry.
    pub(crate) fn answer(&self) -> Answer {
        // An import may bring nothing but a later decision for the same.
        let is_change = |effect: &&Effect| !matches!(effect, Effect::Changed { before, after, .. } if before == after);
        let changes = self.effects.iter().filter(is_change);
        let views: BTreeSet<ViewId> = changes.filter_map(Effect::view).collect();
        Answer {
            sequence: self.sequence,
            n_views: views.len() as u64,
            contradiction: self.contradiction.clone(),
        }
    }
}
