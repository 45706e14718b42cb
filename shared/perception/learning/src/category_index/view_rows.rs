//! Hash map from view id to row with copy-on-write shards.

use crate::ViewId;
use std::collections::HashMap;
use std::sync::Arc;

/// Number of shards. Copying one shard, some hundreds of a hundred thousand views, and
/// sharing all of them both take microseconds.
const N_SHARDS: usize = 256;

/// Row of each view. Clones share the shards; a shared shard is copied when it changes.
#[derive(Debug, Clone)]
pub(super) struct ViewRows {
    shards: Vec<Arc<HashMap<ViewId, usize>>>,
}

impl ViewRows {
    pub(super) fn new() -> Self {
        Self {
            shards: vec![Arc::default(); N_SHARDS],
        }
    }

    pub(super) fn get(&self, id: ViewId) -> Option<usize> {
        self.shards[shard_of(id)].get(&id).copied()
    }

    pub(super) fn insert(&mut self, id: ViewId, row: usize) {
        Arc::make_mut(&mut self.shards[shard_of(id)]).insert(id, row);
    }

    /// Removes a view and returns its row.
    pub(super) fn remove(&mut self, id: ViewId) -> Option<usize> {
        let shard = &mut self.shards[shard_of(id)];
        // An unknown view must not copy a shared shard.
        shard.contains_key(&id).then_some(())?;
        Arc::make_mut(shard).remove(&id)
    }
}

/// Shard of a view; consecutive tracks, and the views of a track, are spread over the
/// shards.
fn shard_of(id: ViewId) -> usize {
    let number = id
        .track_id
        .wrapping_add(u64::from(id.view_id).wrapping_mul(31));
    (number % N_SHARDS as u64) as usize
}
