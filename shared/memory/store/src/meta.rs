//! The one record about the whole store, written with every commit.

use serde::{Deserialize, Serialize};
use serde_bytes::ByteArray;

use crate::digest::Digest;
use crate::error::Error;
use crate::watermark::Mark;

/// The schema of the database that this version writes; older ones are migrated.
pub(crate) const SCHEMA: u32 = 2;

/// Which store this is. A store that lost something gets another id, so that
/// its readers load everything again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct StoreId(pub u128);

/// The record.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Meta {
    pub(crate) schema: u32,
    store_id: ByteArray<16>,
    memory_id: ByteArray<16>,
    /// The first track-id that was never leased; ids begin at one.
    pub(crate) next_track_id: u64,
    /// Sequence of the last history entry, and its digest.
    pub(crate) sequence: u64,
    pub(crate) head: Digest,
    /// Views whose content is there, forgotten ones too.
    pub(crate) n_views: u64,
}

impl Meta {
    /// For an empty store with an id of its own.
    pub(crate) fn new(memory_id: Option<u128>, next_track_id: u64) -> Result<Self, Error> {
        let store_id = random_id()?;
        let memory_id = memory_id.map_or_else(random_id, |id| Ok(id.to_be_bytes()))?;
        Ok(Self {
            schema: SCHEMA,
            store_id: ByteArray::new(store_id),
            memory_id: ByteArray::new(memory_id),
            next_track_id: next_track_id.max(1),
            sequence: 0,
            head: Digest::default(),
            n_views: 0,
        })
    }

    /// For an empty store in which this one's history is to be made again.
    pub(crate) fn before_history(&self) -> Self {
        Self {
            sequence: 0,
            head: Digest::default(),
            n_views: 0,
            ..self.clone()
        }
    }

    pub(crate) fn store_id(&self) -> StoreId {
        StoreId(u128::from_be_bytes(self.store_id.into_array()))
    }

    /// Whose memory this is; it stays when the store is rebuilt.
    pub(crate) fn memory_id(&self) -> u128 {
        u128::from_be_bytes(self.memory_id.into_array())
    }

    /// What the watermark should say once this is on disk.
    pub(crate) fn mark(&self) -> Mark {
        Mark {
            store_id: self.store_id().0,
            memory_id: self.memory_id(),
            sequence: self.sequence,
            next_track_id: self.next_track_id,
            n_views: self.n_views,
        }
    }
}

/// A number that nobody else draws.
pub(crate) fn random_id() -> Result<[u8; 16], Error> {
    let mut id = [0; 16];
    getrandom::fill(&mut id)
        .map_err(|error| std::io::Error::other(error.to_string()))
        .map_err(Error::io("drawing an id from", "the kernel"))?;
    Ok(id)
}
