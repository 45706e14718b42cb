//! What the store can be asked to change.

use std::fmt;

use learning::{CategoryName, ViewId};
use serde::{Deserialize, Serialize};

use crate::document::{Document, DocumentKey};
use crate::error::{Error, Refusal};
use crate::foreign::{ForeignDocument, ForeignView};
use crate::history::Contradiction;
use crate::meta::random_id;
use crate::view::{MAX_NAME_BYTES, View};

/// Most views one mutation may store.
pub const MAX_BATCH_VIEWS: usize = 1024;

/// Most bytes of descriptors and clouds one mutation may store: they are held in
/// memory until they are written.
pub const MAX_BATCH_BYTES: usize = 64 << 20;

/// A number the client draws at random for each mutation and repeats when it
/// asks again, so that a repeated mutation is answered and not made twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MutationId(pub u128);

impl MutationId {
    /// A number that nobody else draws.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the kernel gives no random numbers.
    pub fn random() -> Result<Self, Error> {
        Ok(Self(u128::from_be_bytes(random_id()?)))
    }
}

/// A change asked for, and by whom.
#[derive(Debug, Clone, PartialEq)]
pub struct Mutation {
    /// The client's number for it.
    pub id: MutationId,
    /// Who asks, at most [`MAX_NAME_BYTES`].
    pub author: String,
    /// When, nanoseconds since 1970, UTC.
    pub wall_ns: u64,
    /// What is asked.
    pub change: Change,
}

/// What a name can be given to or taken from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// One view.
    View(ViewId),
    /// All views of a track.
    Track(u64),
    /// All views that carry a name.
    Category(CategoryName),
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::View(view) => write!(f, "{}", crate::error::in_words(*view)),
            Self::Track(track_id) => write!(f, "track {track_id}"),
            Self::Category(name) => write!(f, "the category {name}"),
        }
    }
}

/// The changes there are.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Change {
    /// Store views, 1 to [`MAX_BATCH_VIEWS`] and up to [`MAX_BATCH_BYTES`]; those
    /// stored already with the same content are left as they are.
    StoreViews(Vec<View>),
    /// Give all stored views of a track a name it does not have yet. When it has
    /// another one, nothing changes, and the history keeps who said otherwise.
    Teach {
        /// The track.
        track_id: u64,
        /// Its name.
        category: CategoryName,
    },
    /// Give a view, a track, or all views of a category another name.
    Correct {
        /// What.
        target: Target,
        /// Its right name.
        category: CategoryName,
    },
    /// Forget. Of a category only the name: its views stay, without one. A track
    /// and a view are neither recognised nor taught any more.
    Forget(Target),
    /// Give a category a name that no other has.
    Rename {
        /// Its name.
        from: CategoryName,
        /// Its new name.
        to: CategoryName,
    },
    /// Give all views of a category the name of another.
    MergeCategories {
        /// The category that will be no more.
        from: CategoryName,
        /// The one that gets its views.
        into: CategoryName,
    },
    /// Take an entry of the history back, unless something it changed was changed
    /// since. Without a sequence: the last lesson of this author that still holds.
    Undo {
        /// The entry.
        sequence: Option<u64>,
    },
    /// Take over what another memory knows; where both know of a view, the later
    /// decision holds.
    Import {
        /// Where it comes from, at most [`MAX_NAME_BYTES`].
        source: String,
        /// Its views, up to [`MAX_BATCH_VIEWS`] and [`MAX_BATCH_BYTES`].
        views: Vec<ForeignView>,
        /// Its documents.
        documents: Vec<ForeignDocument>,
    },
    /// Store a document, instead of the one of this name.
    PutDocument(Document),
    /// Remove a document.
    RemoveDocument(DocumentKey),
    /// Remove for good what was forgotten or replaced before a time.
    Purge {
        /// That time, nanoseconds since 1970, UTC.
        before_ns: u64,
    },
}

/// What a mutation did. It is on disk when it is given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answer {
    /// Sequence of the history's entry about it.
    pub sequence: u64,
    /// Number of views that were stored, or that stand for something else since.
    /// Zero: it was so already.
    pub n_views: u64,
    /// Why nothing changed: the history keeps both opinions.
    pub contradiction: Option<Contradiction>,
}

impl Mutation {
    /// Refuses what no state of the store could grant.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        let text = match &self.change {
            Change::Import { source, .. } => source,
            _ => &self.author,
        };
        for text in [&self.author, text] {
            if text.len() > MAX_NAME_BYTES {
                return Err(Refusal::AuthorTooLong {
                    n_bytes: text.len(),
                    most: MAX_NAME_BYTES,
                });
            }
        }
        match &self.change {
            Change::StoreViews(views) => {
                check_batch(
                    views.len().max(1),
                    views.iter().map(View::n_large_bytes).sum(),
                )?;
                if views.is_empty() {
                    return Err(batch_size(0));
                }
                views.iter().try_for_each(View::check)
            }
            Change::Import {
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
            Change::PutDocument(document) => document.check(),
            _ => Ok(()),
        }
    }
}

fn check_batch(n_items: usize, n_bytes: usize) -> Result<(), Refusal> {
    if n_items > MAX_BATCH_VIEWS {
        return Err(batch_size(n_items));
    }
    if n_bytes > MAX_BATCH_BYTES {
        return Err(Refusal::BatchBytes {
            n_bytes,
            most: MAX_BATCH_BYTES,
        });
    }
    Ok(())
}

fn batch_size(n_views: usize) -> Refusal {
    Refusal::BatchSize {
        n_views,
        most: MAX_BATCH_VIEWS,
    }
}
