//! rusty-leveldb behind a wall: what it swallows is told, what it panics at is an error.
//!
//! It is read by iterator only. Its `get` answers wrongly in two cases: it stops
//! at the deletion of the next greater key, and it misses the very last written
//! key where that ends a block.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

use rusty_leveldb::{DB, DBIterator, LdbIterator, Options, StatusCode, WriteBatch};

use crate::durable_env::DurableEnv;
use crate::env_health::{Change, EnvHealth};
use crate::error::Error;

/// Table files kept open; times eight megabytes a file is more than a robot learns.
const MAX_OPEN_FILES: usize = 256;

/// What is usually gathered in memory before it becomes a table, twice the size of
/// tables on the levels below. rusty-leveldb merges once for each table it writes from
/// memory: with four megabytes and its two, what many key views bring in is more
/// than what is merged, and a snapshot is then read from dozens of tables at
/// once. Tests make tables from less.
pub const WRITE_BUFFER_BYTES: usize = if cfg!(test) { 4 << 20 } else { 16 << 20 };

/// An open database.
pub(crate) struct Engine {
    db: DB,
    health: Arc<EnvHealth>,
}

impl Engine {
    /// Opens or creates the database in `folder` to be examined: damage is noted
    /// instead of stopping, and no file is deleted before [`Self::accept`].
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] when it cannot be opened for what is in its files;
    /// [`Error::Io`] and [`Error::InUse`] when that is not their fault.
    pub(crate) fn open(folder: &Path, write_buffer_bytes: usize) -> Result<Self, Error> {
        Self::open_watched(folder, write_buffer_bytes, EnvHealth::examining())
    }

    pub(crate) fn open_watched(
        folder: &Path,
        write_buffer_bytes: usize,
        health: EnvHealth,
    ) -> Result<Self, Error> {
        let health = Arc::new(health);
        let options = Options {
            env: Rc::new(Box::new(DurableEnv::new(Arc::clone(&health)))),
            // With either, what is written after a torn tail is lost at the next open.
            reuse_logs: false,
            reuse_manifest: false,
            max_open_files: MAX_OPEN_FILES,
            write_buffer_size: write_buffer_bytes,
            max_file_size: write_buffer_bytes / 2,
            ..Options::default()
        };
        match guarded(&health, || DB::open(folder, options)) {
            Ok(db) => Ok(Self { db, health }),
            Err(Error::InUse { .. }) => Err(Error::InUse {
                folder: folder.to_owned(),
            }),
            Err(error) => Err(error),
        }
    }

    /// Ends the examination: makes the deletions that were put off, and from now
    /// on any damage stops all changes.
    pub(crate) fn accept(&mut self) -> Result<(), Error> {
        for path in self.health.release_deletions() {
            let change = Change::Delete(&path);
            let delete = || match std::fs::remove_file(&path) {
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
                deleted => deleted,
            };
            let deleted = self.health.change("deleting", &path, &change, delete);
            deleted.map_err(Error::io("deleting", &path))?;
        }
        Ok(())
    }

    /// Applies all of `batch` or nothing; when `is_synced` it is on disk afterwards.
    /// After an error it may be on disk or not, until the database is opened again.
    pub(crate) fn write(&mut self, batch: WriteBatch, is_synced: bool) -> Result<(), Error> {
        guarded(&self.health, || self.db.write(batch, is_synced))?;
        self.check()
    }

    /// Merges the tables that have keys from `from` to `to`.
    pub(crate) fn compact(&mut self, from: &[u8], to: &[u8]) -> Result<(), Error> {
        guarded(&self.health, || self.db.compact_range(from, to))?;
        self.check()
    }

    /// Writes everything out and closes the database.
    pub(crate) fn close(mut self) -> Result<(), Error> {
        guarded(&self.health, || self.db.close())
    }

    /// A reader of the database as it is now.
    pub(crate) fn reader(&mut self) -> Result<Reader, Error> {
        let iter = guarded(&self.health, || self.db.new_iter())?;
        Ok(Reader {
            iter,
            health: Arc::clone(&self.health),
        })
    }

    /// The error to give when something went wrong behind the engine's back.
    pub(crate) fn check(&self) -> Result<(), Error> {
        check(&self.health)
    }

    /// What is damaged: how many places, and the first ones in words.
    pub(crate) fn damages(&self) -> (u64, Vec<String>) {
        self.health.damages()
    }

    #[cfg(test)]
    pub(crate) fn health(&self) -> &Arc<EnvHealth> {
        &self.health
    }
}

/// Reads records in the order of their keys.
pub(crate) struct Reader {
    iter: DBIterator,
    health: Arc<EnvHealth>,
}

impl Reader {
    /// The value of `key`.
    pub(crate) fn get(&mut self, key: &[u8]) -> Result<Option<Vec<u8>>, Error> {
        let mut value = None;
        self.scan(key, |found, bytes| {
            if found == key {
                value = Some(bytes.to_vec());
            }
            ControlFlow::Break(())
        })?;
        Ok(value)
    }

    /// Visits the records from `from` on until `visit` breaks.
    pub(crate) fn scan(
        &mut self,
        from: &[u8],
        mut visit: impl FnMut(&[u8], &[u8]) -> ControlFlow<()>,
    ) -> Result<(), Error> {
        guarded(&self.health, || {
            if from.is_empty() {
                // A seek into a damaged block would skip the whole table.
                self.iter.seek_to_first();
            } else {
                self.iter.seek(from);
            }
            while let Some((key, value)) = self.iter.current() {
                if visit(&key, &value).is_break() {
                    break;
                }
                self.iter.advance();
            }
            Ok(())
        })?;
        check(&self.health)
    }

    /// Visits the records whose key begins with `prefix`.
    pub(crate) fn scan_prefix(
        &mut self,
        prefix: &[u8],
        mut visit: impl FnMut(&[u8], &[u8]),
    ) -> Result<(), Error> {
        self.scan(prefix, |key, value| {
            if !key.starts_with(prefix) {
                return ControlFlow::Break(());
            }
            visit(key, value);
            ControlFlow::Continue(())
        })
    }
}

fn check(health: &EnvHealth) -> Result<(), Error> {
    if let Some(failure) = health.failure() {
        return Err(failure.into());
    }
    if health.n_damages() > 0 && !health.is_examining() {
        return Err(Error::Damaged {
            what: health.damages().1.join("; "),
        });
    }
    Ok(())
}

/// Calls into rusty-leveldb, which asserts where a file may be damaged.
fn guarded<T>(
    health: &EnvHealth,
    call: impl FnOnce() -> rusty_leveldb::Result<T>,
) -> Result<T, Error> {
    // After a panic the database is not used again: the damage is noted, and
    // whoever sees it opens the store anew.
    let what = match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(value)) => return Ok(value),
        Ok(Err(status)) if status.code == StatusCode::LockError => {
            return Err(Error::InUse {
                folder: std::path::PathBuf::new(),
            });
        }
        Ok(Err(status)) => status.err,
        Err(_) => "rusty-leveldb panicked".to_owned(),
    };
    if let Some(failure) = health.failure() {
        return Err(failure.into());
    }
    health.note_damage(what.clone());
    Err(Error::Damaged { what })
}
