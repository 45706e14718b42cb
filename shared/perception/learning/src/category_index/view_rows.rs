//! In which row a view is.

use crate::ViewId;
use std::collections::HashMap;
use std::sync::Arc;

/// Pieces of the map. Copying a piece, some hundreds of views in a hundred
/// thousand, and sharing all of them both take microseconds.
const N_PIECES: usize = 256;

/// Rows by view. A copy shares all pieces; a piece is copied when it changes while
/// a copy holds it.
#[derive(Debug, Clone)]
pub(super) struct ViewRows {
    pieces: Vec<Arc<HashMap<ViewId, usize>>>,
}

impl ViewRows {
    pub(super) fn new() -> Self {
        Self {
            pieces: vec![Arc::default(); N_PIECES],
        }
    }

    pub(super) fn get(&self, id: ViewId) -> Option<usize> {
        self.pieces[piece_of(id)].get(&id).copied()
    }

    pub(super) fn insert(&mut self, id: ViewId, row: usize) {
        Arc::make_mut(&mut self.pieces[piece_of(id)]).insert(id, row);
    }

    /// Removes a view and returns its row.
    pub(super) fn remove(&mut self, id: ViewId) -> Option<usize> {
        let piece = &mut self.pieces[piece_of(id)];
        // What is not there must not copy a shared piece.
        piece.contains_key(&id).then_some(())?;
        Arc::make_mut(piece).remove(&id)
    }
}

/// Consecutive tracks, and the views of one track, are spread over the pieces.
fn piece_of(id: ViewId) -> usize {
    let number = id
        .track_id
        .wrapping_add(u64::from(id.view_id).wrapping_mul(31));
    (number % N_PIECES as u64) as usize
}
