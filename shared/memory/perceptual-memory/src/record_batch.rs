//! Atomic batch of record writes.

use durable_leveldb::{Database, WriteBatch, record::seal};
use serde::Serialize;

use crate::error::Error;
use crate::keys;
use crate::meta::Meta;

/// Records written atomically.
#[derive(Default)]
pub(crate) struct RecordBatch {
    batch: WriteBatch,
    n_bytes: usize,
    is_touched: bool,
}

impl RecordBatch {
    /// Marks the metadata record for writing even without other records.
    pub(crate) fn touch(&mut self) {
        self.is_touched = true;
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.n_bytes == 0 && !self.is_touched
    }

    pub(crate) fn put<T: Serialize>(&mut self, key: &[u8], value: &T) {
        self.put_sealed(key, &seal(key, value));
    }

    pub(crate) fn put_sealed(&mut self, key: &[u8], record: &[u8]) {
        self.batch.put(key, record);
        self.n_bytes += key.len() + record.len();
    }

    pub(crate) fn delete(&mut self, key: &[u8]) {
        self.batch.delete(key);
        self.n_bytes += key.len();
    }

    pub(crate) fn n_bytes(&self) -> usize {
        self.n_bytes
    }

    /// Writes and syncs the batch together with the metadata record.
    pub(crate) fn commit(mut self, engine: &mut Database, meta: &Meta) -> Result<(), Error> {
        self.put(&[keys::META], meta);
        // The write returns after `fdatasync` of the log: the batch survives a power failure.
        let is_synced = true;
        Ok(engine.write(self.batch, is_synced)?)
    }

    /// Writes the batch without a sync, into a database that is not in use yet.
    pub(crate) fn flush(self, engine: &mut Database) -> Result<(), Error> {
        if self.n_bytes == 0 {
            Ok(())
        } else {
            let is_synced = false;
            Ok(engine.write(self.batch, is_synced)?)
        }
    }
}
