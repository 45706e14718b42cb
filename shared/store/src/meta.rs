//! The one record about the whole store, written with every commit.

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::watermark::Mark;

/// The newest schema of the database that this version knows.
pub(crate) const SCHEMA: u32 = 1;

/// Which store this is. A store that lost something gets another id, so that
/// its readers load everything again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct StoreId(pub u128);

/// The record.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Meta {
    pub(crate) schema: u32,
    #[serde(with = "serde_bytes")]
    store_id: [u8; 16],
    /// The first track-id that was never leased; ids begin at one.
    pub(crate) next_track_id: u64,
    /// Number of history entries, and the sequence of the last.
    pub(crate) sequence: u64,
    pub(crate) n_views: u64,
}

impl Meta {
    /// For an empty store with an id of its own.
    pub(crate) fn new(next_track_id: u64) -> Result<Self, Error> {
        let mut store_id = [0; 16];
        getrandom::fill(&mut store_id)
            .map_err(|error| std::io::Error::other(error.to_string()))
            .map_err(Error::io("drawing a store id from", "the kernel"))?;
        Ok(Self {
            schema: SCHEMA,
            store_id,
            next_track_id: next_track_id.max(1),
            sequence: 0,
            n_views: 0,
        })
    }

    pub(crate) fn store_id(&self) -> StoreId {
        StoreId(u128::from_be_bytes(self.store_id))
    }

    /// What the watermark should say once this is on disk.
    pub(crate) fn mark(&self) -> Mark {
        Mark {
            store_id: self.store_id().0,
            sequence: self.sequence,
            next_track_id: self.next_track_id,
        }
    }
}
