//! Metadata record of the store, written with every commit.

use durable_leveldb::random_id;
use serde::{Deserialize, Serialize};
use serde_bytes::ByteArray;

use crate::digest::Digest;
use crate::error::Error;
use crate::watermark::WatermarkRecord;

/// Schema version of this program; older databases are migrated.
pub(crate) const SCHEMA: u32 = 3;

/// Id of a store. A rebuild after a loss changes it, so that readers load a new snapshot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct StoreId(pub u128);

/// Metadata record.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Meta {
    pub(crate) schema: u32,
    pub(crate) store_id: ByteArray<16>,
    pub(crate) memory_id: ByteArray<16>,
    /// Track-id counter: first id that was never leased. Ids begin at one.
    pub(crate) next_track_id: u64,
    /// Sequence number of the last history entry.
    pub(crate) sequence: u64,
    pub(crate) head: Digest,
    /// Number of views with content, including forgotten ones.
    pub(crate) n_views: u64,
    /// Digest of all records of views, documents and tombstones; absent in schema 2.
    #[serde(default)]
    pub(crate) records: Digest,
}

impl Meta {
    /// Metadata of an empty store with a new id.
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
            records: Digest::default(),
        })
    }

    /// Metadata with which a replay of the history begins.
    pub(crate) fn before_history(&self) -> Self {
        Self {
            sequence: 0,
            head: Digest::default(),
            n_views: 0,
            records: Digest::default(),
            ..self.clone()
        }
    }

    pub(crate) fn store_id(&self) -> StoreId {
        StoreId(u128::from_be_bytes(self.store_id.into_array()))
    }

    /// Id of the memory; a rebuild keeps it.
    pub(crate) fn memory_id(&self) -> u128 {
        u128::from_be_bytes(self.memory_id.into_array())
    }

    /// Watermark that corresponds to this metadata.
    pub(crate) fn mark(&self) -> WatermarkRecord {
        WatermarkRecord {
            store_id: self.store_id().0,
            memory_id: self.memory_id(),
            sequence: self.sequence,
            next_track_id: self.next_track_id,
            n_views: self.n_views,
        }
    }
}
