//! Plain data types of the perceptual memory: targets, operations, effects,
//! answers, losses, limits.

use std::fmt;

use learning::{CategoryName, ViewId};
use serde::{Deserialize, Serialize};

use crate::digest::Digest;
use crate::document::DocumentContent;
use crate::document_key::DocumentKey;
use crate::history_limits::HistoryLimits;
use crate::label_status::{DecisionStamp, LabelStatus};

/// Set of views that a label change applies to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// One view, by its id.
    #[serde(rename = "captured_view")]
    View(ViewId),
    /// All views of a track, by its track-id.
    Track(u64),
    /// All views of a category.
    Category(CategoryName),
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::View(view) => write!(f, "{}", crate::view_phrase::view_phrase(*view)),
            Self::Track(track_id) => write!(f, "track {track_id}"),
            Self::Category(name) => write!(f, "the category {name}"),
        }
    }
}

/// Requested operation of a history entry.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Operation {
    /// Storing of views.
    StoreViews,
    /// Labelling of a track.
    Teach {
        /// Track-id of the labelled track.
        track_id: u64,
        /// Category label that the track received.
        category: CategoryName,
    },
    /// Relabelling of a track or view.
    Correct {
        /// Relabelled track, view or category.
        target: Target,
        /// Category label that the views received.
        category: CategoryName,
    },
    /// Removal of a label, or forgetting of views.
    Forget {
        /// Forgotten category, track or view.
        target: Target,
    },
    /// Renaming of a category.
    Rename {
        /// Category name before the renaming.
        from: CategoryName,
        /// Category name after the renaming.
        to: CategoryName,
    },
    /// Merge of two categories.
    MergeCategories {
        /// Category that was merged away.
        from: CategoryName,
        /// Category that received the merged views.
        into: CategoryName,
    },
    /// Undo of an earlier history entry.
    Undo {
        /// Sequence number of the undone entry.
        sequence: u64,
        /// Redo: the change that is in effect again, since `sequence` is an undo of it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        redone: Option<u64>,
    },
    /// Import of a part of another memory's export.
    Import {
        /// Name of the source, as the requester gave it.
        source: String,
        /// Place of the entry among those of its import.
        #[serde(default, skip_serializing_if = "ImportPart::is_whole")]
        part: ImportPart,
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
    /// Names of categories brought into the form that names have today.
    NormaliseNames {
        /// Names before and after; categories of equal names were joined.
        names: Vec<(CategoryName, CategoryName)>,
    },
    /// Permanent deletion of forgotten or replaced content.
    Purge,
    /// Enforcement of a retention limit: views of a category were forgotten, or unlabelled views
    /// were deleted.
    #[serde(rename = "economise")]
    EnforceLimit {
        /// Category above its limit; `None` for unlabelled views.
        category: Option<CategoryName>,
    },
    /// Rebuild of a damaged store from its intact records.
    Rebuild {
        /// Content lost in the rebuild.
        loss: DataLoss,
        /// First and last sequence numbers of each range of lost entries.
        lost: Vec<(u64, u64)>,
    },
    /// Migration of the store from an older schema.
    Migrate {
        /// Schema version before the migration.
        schema: u32,
    },
}

/// Place of a history entry among the entries of one import, which are undone together.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImportPart {
    /// Sequence number of the first entry of the import; `None` for the first one itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<u64>,
    /// `true` if another entry of the import follows.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_continued: bool,
}

impl ImportPart {
    /// `true` for an import of one entry.
    pub(crate) fn is_whole(&self) -> bool {
        *self == Self::default()
    }
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
        /// Id of the view whose label status changed.
        #[serde(rename = "v")]
        view: ViewId,
        /// Label status before the change.
        #[serde(rename = "b")]
        before: LabelStatus,
        /// Label status after the change.
        #[serde(rename = "a")]
        after: LabelStatus,
        /// Author and time of the decision, if they differ from those of the entry.
        #[serde(rename = "d", default, skip_serializing_if = "Option::is_none")]
        decided: Option<DecisionStamp>,
    },
    /// Permanent deletion of a view.
    #[serde(rename = "p")]
    Purged {
        /// Id of the purged view.
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
        decided: Option<DecisionStamp>,
    },
    /// Replacement of the content of a document.
    #[serde(rename = "d")]
    Document {
        /// Key of the document.
        #[serde(rename = "k")]
        document: DocumentKey,
        /// Content before the change; `None` if there was no document.
        #[serde(rename = "b")]
        before: Option<DocumentContent>,
        /// Content after the change; `None` if the document was removed.
        #[serde(rename = "a")]
        after: Option<DocumentContent>,
        /// Author and time of the decision, if they differ from those of the entry.
        #[serde(rename = "w", default, skip_serializing_if = "Option::is_none")]
        decided: Option<DecisionStamp>,
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
    /// Present label of the contradicted track.
    pub present: CategoryName,
    /// Author and time of the present label.
    pub decided: DecisionStamp,
}

/// Result of a mutation that is on disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MutationReceipt {
    /// Sequence number of the history entry.
    pub sequence: u64,
    /// Number of views that were stored or changed their label status; zero if the state was
    /// reached already.
    pub n_views: u64,
    /// Contradicted label, if the mutation changed nothing for that reason. The history keeps both
    /// opinions.
    pub contradiction: Option<Contradiction>,
}

/// Content lost in a rebuild.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DataLoss {
    /// Number of acknowledged history entries that are lost.
    pub n_history: u64,
    /// Number of views whose metadata or descriptor is lost.
    pub n_views: u64,
    /// Number of views that are kept without their point cloud.
    pub n_clouds: u64,
    /// Number of document versions whose content is lost.
    pub n_documents: u64,
}

impl fmt::Display for DataLoss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            n_history,
            n_views,
            n_clouds,
            n_documents,
        } = self;
        write!(
            f,
            "{n_history} history entries, {n_views} views, {n_clouds} clouds, {n_documents} \
             documents"
        )
    }
}

/// Retention limits of a store.
///
/// An exceeded limit is enforced down to nine tenths, so that this does not happen at every
/// mutation (hysteresis):
///
/// - of a category, the most redundant views are forgotten: of the two most similar views
///   the older one, repeatedly. This can be undone until the next purge.
/// - of the unlabelled views, those of the oldest tracks are deleted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RetentionLimits {
    /// Maximum number of views of a category.
    pub max_views_per_category: usize,
    /// Maximum number of unlabelled views.
    pub max_unnamed_views: usize,
    /// Limits of the history.
    pub history: HistoryLimits,
}

impl Default for RetentionLimits {
    /// No retention limits.
    fn default() -> Self {
        Self {
            max_views_per_category: usize::MAX,
            max_unnamed_views: usize::MAX,
            history: HistoryLimits::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use durable_leveldb::record::{seal, unseal};

    /// Operations as they were stored before an undo could name a redone change, and an import its
    /// first entry.
    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum EarlierOperation {
        Undo { sequence: u64 },
        Import { source: String },
    }

    #[test]
    fn operation_of_an_earlier_version_is_read_and_stored_as_it_was() {
        let source = || "anna".to_owned();
        let (earlier_undo, earlier_import) = (
            EarlierOperation::Undo { sequence: 4 },
            EarlierOperation::Import { source: source() },
        );
        let undo = |redone| Operation::Undo {
            sequence: 4,
            redone,
        };
        let import = |first, is_continued| Operation::Import {
            source: source(),
            part: ImportPart {
                first,
                is_continued,
            },
        };
        for (earlier, operation) in [
            (&earlier_undo, undo(None)),
            (&earlier_import, import(None, false)),
        ] {
            let record = seal(b"h", earlier);
            assert_eq!(seal(b"h", &operation), record);
            assert_eq!(unseal::<Operation>(b"h", &record).unwrap(), operation);
        }
        // The earlier version reads what is stored now, too: a redo is the undo of an undo.
        for (earlier, operation) in [
            (&earlier_undo, undo(Some(3))),
            (&earlier_import, import(Some(2), true)),
        ] {
            let record = seal(b"h", &operation);
            let read: EarlierOperation = unseal(b"h", &record).unwrap();
            assert_eq!(read, *earlier);
            assert_eq!(unseal::<Operation>(b"h", &record).unwrap(), operation);
        }
    }
}
