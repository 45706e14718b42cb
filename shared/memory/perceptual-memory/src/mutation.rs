//! Mutations: requested changes of the store, idempotent by a client-drawn id.

use durable_leveldb::MutationId;
use learning::CategoryName;

use crate::document::MemoryDocument;
use crate::document_key::DocumentKey;
use crate::error::StoreRefusal;
use crate::exchange::{ForeignDocument, ForeignView};
use crate::model::{ImportPart, Target};
use crate::requester::Requester;
use crate::view::{CapturedView, MAX_NAME_BYTES};

/// Maximum number of views in one mutation.
pub const MAX_BATCH_VIEWS: usize = 1024;

/// Maximum size of descriptors and point clouds in one mutation, bytes. They are held in memory
/// until they are written.
pub const MAX_BATCH_BYTES: usize = 64 << 20;

/// Requested change with its author and time.
#[derive(Debug, Clone, PartialEq)]
pub struct Mutation {
    /// Idempotency key of the client.
    pub id: MutationId,
    /// Author of the mutation, at most [`MAX_NAME_BYTES`].
    pub author: String,
    /// User who sent the mutation.
    pub requester: Requester,
    /// Time of the request, nanoseconds since 1970, UTC.
    pub wall_ns: u64,
    /// Requested change of the store.
    pub change: StoreChange,
}

/// Kinds of changes to the store.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum StoreChange {
    /// Store 1 to [`MAX_BATCH_VIEWS`] views of up to [`MAX_BATCH_BYTES`] under leased track-ids.
    /// Views that are stored already with the same content are left unchanged.
    StoreViews(Vec<CapturedView>),
    /// Label all views of an unlabelled track. If the track has another label, nothing changes and
    /// the history records the contradiction.
    Teach {
        /// Track-id of the track to label.
        track_id: u64,
        /// Category label to assign.
        category: CategoryName,
    },
    /// Relabel a view, a track, or all views of a category.
    Correct {
        /// Views to relabel.
        target: Target,
        /// New category label of the views.
        category: CategoryName,
    },
    /// Forget a target. Of a category only the label is removed and its views stay; a track or view
    /// is excluded from recognition and teaching.
    Forget(Target),
    /// Rename a category to an unused name.
    Rename {
        /// Present category name.
        from: CategoryName,
        /// New category name.
        to: CategoryName,
    },
    /// Merge two categories.
    MergeCategories {
        /// Category that is merged away.
        from: CategoryName,
        /// Category that receives the merged views.
        into: CategoryName,
    },
    /// Make a change, even if it makes a category with a name like that of another one.
    AllowingAlike(Box<Self>),
    /// Write all names of categories as they would be given today, and join those that become
    /// equal.
    NormaliseNames,
    /// Undo a history entry, unless its effects were changed later or the requester has no right
    /// to. Without a sequence number: the last change of this author and user that is still in
    /// effect.
    Undo {
        /// Sequence number of the entry to undo.
        sequence: Option<u64>,
    },
    /// Redo the change that this author and user undid last, if they changed nothing since.
    Redo,
    /// Merge the export of another memory; for each view the later decision wins.
    Import {
        /// Name of the source, at most [`MAX_NAME_BYTES`].
        source: String,
        /// Imported views, up to [`MAX_BATCH_VIEWS`] and [`MAX_BATCH_BYTES`].
        views: Vec<ForeignView>,
        /// Documents to import.
        documents: Vec<ForeignDocument>,
        /// Place among the mutations of one import, which are undone together.
        part: ImportPart,
    },
    /// Store a document, replacing the one with the same key.
    PutDocument(MemoryDocument),
    /// Remove a document.
    RemoveDocument(DocumentKey),
    /// Permanently delete content that was forgotten or replaced before a time: up to a thousand
    /// views and as many versions of documents. Repeat it while [something is due].
    ///
    /// [something is due]: crate::PerceptualMemory::has_purgeable
    Purge {
        /// Cut-off time, nanoseconds since 1970, UTC.
        before_ns: u64,
    },
    /// Delete up to a thousand tombstones of views that were forgotten, and notes of documents that
    /// were removed, before a time. A merge can bring these back from then on.
    PurgeTombstones {
        /// Cut-off time, nanoseconds since 1970, UTC.
        before_ns: u64,
    },
}

impl Mutation {
    /// Validates everything that does not depend on the state of the store.
    pub(crate) fn check(&self) -> Result<(), StoreRefusal> {
        let change = match &self.change {
            StoreChange::AllowingAlike(change) => change,
            change => change,
        };
        let text = match change {
            StoreChange::Import { source, .. } => source,
            _ => &self.author,
        };
        for text in [&self.author, text] {
            if text.len() > MAX_NAME_BYTES {
                return Err(StoreRefusal::AuthorTooLong {
                    n_bytes: text.len(),
                    most: MAX_NAME_BYTES,
                });
            }
        }
        match change {
            StoreChange::StoreViews(views) => {
                check_batch(
                    views.len().max(1),
                    views.iter().map(CapturedView::n_large_bytes).sum(),
                )?;
                if views.is_empty() {
                    return Err(batch_size(0));
                }
                views.iter().try_for_each(CapturedView::check)
            }
            StoreChange::Import {
                views, documents, ..
            } => {
                let n_bytes = views.iter().map(ForeignView::n_large_bytes).sum::<usize>()
                    + documents
                        .iter()
                        .map(ForeignDocument::n_bytes)
                        .sum::<usize>();
                check_batch(views.len() + documents.len(), n_bytes)?;
                let now_ns = self.wall_ns;
                views.iter().try_for_each(|view| view.check(now_ns))?;
                documents
                    .iter()
                    .try_for_each(|document| document.check(now_ns))
            }
            StoreChange::PutDocument(document) => document.check(),
            _ => Ok(()),
        }
    }
}

fn check_batch(n_items: usize, n_bytes: usize) -> Result<(), StoreRefusal> {
    if n_items > MAX_BATCH_VIEWS {
        return Err(batch_size(n_items));
    }
    if n_bytes > MAX_BATCH_BYTES {
        return Err(StoreRefusal::BatchBytes {
            n_bytes,
            most: MAX_BATCH_BYTES,
        });
    }
    Ok(())
}

fn batch_size(n_views: usize) -> StoreRefusal {
    StoreRefusal::BatchSize {
        n_views,
        most: MAX_BATCH_VIEWS,
    }
}
