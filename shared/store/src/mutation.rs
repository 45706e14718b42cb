//! What the store can be asked to change.

use learning::CategoryName;
use serde::{Deserialize, Serialize};

use crate::error::Refusal;
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

/// The changes there are.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Change {
    /// Store views, 1 to [`MAX_BATCH_VIEWS`] and up to [`MAX_BATCH_BYTES`]; those stored already with the same
    /// content are left as they are.
    StoreViews(Vec<View>),
    /// Give all stored views of a track a name it does not have yet.
    Teach {
        /// The track.
        track_id: u64,
        /// Its name.
        category: CategoryName,
    },
    /// Give all stored views of a track another name.
    Correct {
        /// The track.
        track_id: u64,
        /// Its right name.
        category: CategoryName,
    },
    /// Take a name from all views that carry it; the views stay, without one.
    Forget {
        /// The name.
        category: CategoryName,
    },
}

/// What a mutation did. It is on disk when it is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Answer {
    /// Sequence of the history at which the asked state holds.
    pub sequence: u64,
    /// Number of views that were stored, or whose name changed. Zero: it was so already.
    pub n_views: u64,
}

impl Mutation {
    /// Refuses what no state of the store could grant.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        if self.author.len() > MAX_NAME_BYTES {
            return Err(Refusal::AuthorTooLong {
                n_bytes: self.author.len(),
                most: MAX_NAME_BYTES,
            });
        }
        let Change::StoreViews(views) = &self.change else {
            return Ok(());
        };
        if views.is_empty() || views.len() > MAX_BATCH_VIEWS {
            return Err(Refusal::BatchSize {
                n_views: views.len(),
                most: MAX_BATCH_VIEWS,
            });
        }
        let n_bytes = views.iter().map(View::n_large_bytes).sum();
        if n_bytes > MAX_BATCH_BYTES {
            return Err(Refusal::BatchBytes {
                n_bytes,
                most: MAX_BATCH_BYTES,
            });
        }
        views.iter().try_for_each(View::check)
    }
}
