//! The history: every change ever made, numbered from one, each entry naming the
//! digest of the one before, so that none can be lost, altered or put in unseen.
//!
//! An entry says what was asked and everything it changed. What the store holds
//! is what the entries make of an empty one; see [`crate::replay`].

use std::collections::BTreeSet;
use std::sync::Arc;

use learning::{CategoryName, ViewId};
use serde::{Deserialize, Serialize};
use serde_bytes::ByteArray;

use crate::digest::{Digest, Hasher};
use crate::document::{DocumentContent, DocumentKey};
use crate::keys;
use crate::mutation::{Answer, MutationId, Target};
use crate::record::{seal, unseal};
use crate::salvage::Loss;
use crate::standing::{Decided, Standing};

/// What was asked for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Operation {
    /// Views were stored.
    StoreViews,
    /// A track was given a name.
    Teach {
        /// The track.
        track_id: u64,
        /// The name.
        category: CategoryName,
    },
    /// A track or view was given another name.
    Correct {
        /// Which.
        target: Target,
        /// The name.
        category: CategoryName,
    },
    /// A name was taken away, or views were forgotten.
    Forget {
        /// What.
        target: Target,
    },
    /// A category was given another name.
    Rename {
        /// Its name before.
        from: CategoryName,
        /// Its name since.
        to: CategoryName,
    },
    /// All views of a category went to another.
    MergeCategories {
        /// The category that is no more.
        from: CategoryName,
        /// The one that has its views.
        into: CategoryName,
    },
    /// An entry was taken back.
    Undo {
        /// Which one.
        sequence: u64,
    },
    /// A part of another memory came in.
    Import {
        /// Where from, in the words of whoever asked.
        source: String,
    },
    /// A document was stored.
    PutDocument {
        /// Which one.
        document: DocumentKey,
    },
    /// A document was removed.
    RemoveDocument {
        /// Which one.
        document: DocumentKey,
    },
    /// Content that nothing can bring back any more was removed.
    Purge,
    /// Views were given up to hold a limit: of a category, or of views without name.
    Economise {
        /// The category.
        category: Option<CategoryName>,
    },
    /// The store was rebuilt from what a damaged one still held.
    Rebuild {
        /// What it lost.
        loss: Loss,
        /// First and last sequence of entries that are lost.
        lost: Vec<(u64, u64)>,
    },
    /// The store was brought from an older schema to this one.
    Migrate {
        /// The older schema.
        schema: u32,
    },
}

/// One thing an entry changed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Effect {
    /// A view came in, without a name.
    #[serde(rename = "s")]
    Stored {
        /// Its id here.
        #[serde(rename = "v")]
        view: ViewId,
        /// Digest of everything in it.
        #[serde(rename = "i")]
        identity: Digest,
    },
    /// A view stands for something else.
    #[serde(rename = "c")]
    Changed {
        /// The view.
        #[serde(rename = "v")]
        view: ViewId,
        /// What it stood for.
        #[serde(rename = "b")]
        before: Standing,
        /// What it stands for since.
        #[serde(rename = "a")]
        after: Standing,
        /// Who decided that and when, if not who asked for this entry.
        #[serde(rename = "d", default, skip_serializing_if = "Option::is_none")]
        decided: Option<Decided>,
    },
    /// A view is gone for good.
    #[serde(rename = "p")]
    Purged {
        /// The view.
        #[serde(rename = "v")]
        view: ViewId,
    },
    /// A view that is not here is remembered as forgotten, or no longer so.
    #[serde(rename = "t")]
    Tombstone {
        /// Digest of everything that was in it.
        #[serde(rename = "i")]
        identity: Digest,
        /// Who forgot it and when; none: it may come in again.
        #[serde(rename = "d")]
        decided: Option<Decided>,
    },
    /// A document has other content.
    #[serde(rename = "d")]
    Document {
        /// Which one.
        #[serde(rename = "k")]
        document: DocumentKey,
        /// Its content before.
        #[serde(rename = "b")]
        before: Option<DocumentContent>,
        /// Its content since.
        #[serde(rename = "a")]
        after: Option<DocumentContent>,
        /// Who decided that and when, if not who asked for this entry.
        #[serde(rename = "w", default, skip_serializing_if = "Option::is_none")]
        decided: Option<Decided>,
    },
    /// An earlier version of a document is gone for good.
    #[serde(rename = "q")]
    VersionPurged {
        /// Which one.
        #[serde(rename = "k")]
        document: DocumentKey,
        /// Sequence of the entry that made the version.
        #[serde(rename = "n")]
        sequence: u64,
    },
}

impl Effect {
    /// The view it is about.
    pub fn view(&self) -> Option<ViewId> {
        match self {
            Self::Stored { view, .. } | Self::Changed { view, .. } | Self::Purged { view } => {
                Some(*view)
            }
            _ => None,
        }
    }
}

/// Whether a sequence lies in one of the ranges, each of a first and a last one.
pub(crate) fn is_among(ranges: &[(u64, u64)], sequence: u64) -> bool {
    let mut ranges = ranges.iter();
    ranges.any(|(first, last)| (*first..=*last).contains(&sequence))
}

/// Somebody said something else than what holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Contradiction {
    /// What the track is called.
    pub present: CategoryName,
    /// Who called it so, and when.
    pub decided: Decided,
}

/// One change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HistoryEntry {
    /// Its number, from one.
    pub sequence: u64,
    /// Digest of the entry before; zero for the first.
    pub previous: Digest,
    /// When it was asked for, nanoseconds since 1970, UTC.
    pub wall_ns: u64,
    /// Who asked.
    pub author: Arc<str>,
    /// What was asked.
    pub operation: Operation,
    /// The mutation that asked; none for what the store does by itself.
    pub mutation: Option<MutationId>,
    /// What it changed.
    pub effects: Vec<Effect>,
    /// Why it changed nothing: what holds is something else.
    pub contradiction: Option<Contradiction>,
}

/// An entry as it is stored, under its sequence.
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
    /// The record to store it in, and its digest.
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

    /// The entry in a record, and its digest.
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

    /// What the next entry names as the one before.
    fn digest_of(sequence: u64, record: &[u8]) -> Digest {
        Hasher::new(b"tabula history 2")
            .update(&sequence.to_le_bytes())
            .update(record)
            .finish()
    }

    /// What is answered to whoever asked for it.
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
