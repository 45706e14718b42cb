//! A batch of writes in the making: records sealed under their keys.

use rusty_leveldb::WriteBatch;
use serde::Serialize;

use crate::engine::Engine;
use crate::error::Error;
use crate::keys;
use crate::meta::Meta;
use crate::record::seal;

/// Writes that are made together or not at all.
#[derive(Default)]
pub(crate) struct Writes {
    batch: WriteBatch,
    n_bytes: usize,
    is_touched: bool,
}

impl Writes {
    /// Has the record about the store written even when nothing else is.
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

    /// Writes everything, with the record about the store, and syncs it.
    pub(crate) fn commit(mut self, engine: &mut Engine, meta: &Meta) -> Result<(), Error> {
        self.put(&[keys::META], meta);
        engine.write(self.batch, true)
    }

    /// Writes everything into a database that is not in use yet.
    pub(crate) fn flush(self, engine: &mut Engine) -> Result<(), Error> {
        if self.n_bytes == 0 {
            Ok(())
        } else {
            engine.write(self.batch, false)
        }
    }
}
