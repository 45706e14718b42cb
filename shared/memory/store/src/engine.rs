//! rusty-leveldb behind a wall: what it swallows is told, what it panics at is an error.
//!
//! It is read by iterator only. Its `get` answers wrongly in two cases: it stops
//! at the deletion of the next greater key, and it misses the very last written
//! key where that ends a block.
//!
//! Every iterator takes a snapshot, and of these it never notices that the last one
//! is gone: from the first reading on, merging keeps every version of every record,
//! so that what was removed stays on disk for ever. Therefore the database is opened
//! again after readings, before anything is merged to make room.

use std::io;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use rusty_leveldb::{DB, DBIterator, LdbIterator, Options, StatusCode, WriteBatch};

use crate::durable_env::DurableEnv;
use crate::env_health::{Change, EnvHealth};
use crate::error::Error;

/// Table files kept open; times eight megabytes a file is more than a robot learns.
const MAX_OPEN_FILES: usize = 256;

/// Blocks of tables kept in memory. A block is as long as a record at least, and some
/// records are whole clouds: with the thousand that are usual, reading and merging
/// would leave a thousand clouds behind. Hardly any block is read twice, and the
/// system keeps those of its files that are.
const N_CACHED_BLOCKS: usize = 16;

/// What is usually gathered in memory before it becomes a table, twice the size of
/// tables on the levels below. rusty-leveldb merges once for each table it writes from
/// memory: with four megabytes and its two, what many key views bring in is more
/// than what is merged, and a snapshot is then read from dozens of tables at
/// once. Tests make tables from less.
pub const WRITE_BUFFER_BYTES: usize = if cfg!(test) { 4 << 20 } else { 16 << 20 };

/// An open database.
pub(crate) struct Engine {
    /// `None` when it could not be opened again.
    db: Option<DB>,
    folder: PathBuf,
    write_buffer_bytes: usize,
    /// Whether anything was read since it was opened.
    was_read: bool,
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
        Ok(Self {
            db: Some(open_database(folder, write_buffer_bytes, &health)?),
            folder: folder.to_owned(),
            write_buffer_bytes,
            was_read: false,
            health,
        })
    }

    /// Ends the examination: makes the deletions that were put off, and from now
    /// on any damage stops all changes, and no merging keeps what was removed.
    pub(crate) fn accept(&mut self) -> Result<(), Error> {
        for path in self.health.release_deletions() {
            let change = Change::Delete(&path);
            let delete = || match std::fs::remove_file(&path) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
                deleted => deleted,
            };
            let deleted = self.health.change("deleting", &path, &change, delete);
            deleted.map_err(Error::io("deleting", &path))?;
        }
        self.forget_readings()
    }

    /// Applies all of `batch` or nothing; when `is_synced` it is on disk afterwards.
    /// After an error it may be on disk or not, until the database is opened again.
    pub(crate) fn write(&mut self, batch: WriteBatch, is_synced: bool) -> Result<(), Error> {
        self.call(|db| db.write(batch, is_synced))?;
        self.check()
    }

    /// Merges the tables that have keys from `from` to `to`, without what was removed.
    pub(crate) fn compact(&mut self, from: &[u8], to: &[u8]) -> Result<(), Error> {
        self.forget_readings()?;
        self.call(|db| db.compact_range(from, to))?;
        self.check()
    }

    /// Opens the database again when anything was read since.
    fn forget_readings(&mut self) -> Result<(), Error> {
        if !self.was_read {
            return Ok(());
        }
        self.call(DB::close)?;
        self.db = None;
        let opened = open_database(&self.folder, self.write_buffer_bytes, &self.health)?;
        self.db = Some(opened);
        self.was_read = false;
        Ok(())
    }

    fn call<T>(
        &mut self,
        work: impl FnOnce(&mut DB) -> rusty_leveldb::Result<T>,
    ) -> Result<T, Error> {
        match &mut self.db {
            Some(db) => guarded(&self.health, || work(db)),
            None => Err(Error::io("using", &self.folder)(io::Error::other(
                "it could not be opened again",
            ))),
        }
    }

    /// Writes everything out and closes the database.
    pub(crate) fn close(mut self) -> Result<(), Error> {
        self.call(DB::close)
    }

    /// A reader of the database as it is now.
    pub(crate) fn reader(&mut self) -> Result<Reader, Error> {
        self.was_read = true;
        let iter = self.call(DB::new_iter)?;
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

fn open_database(
    folder: &Path,
    write_buffer_bytes: usize,
    health: &Arc<EnvHealth>,
) -> Result<DB, Error> {
    let usual = Options::default();
    let options = Options {
        env: Rc::new(Box::new(DurableEnv::new(Arc::clone(health)))),
        // With either, what is written after a torn tail is lost at the next open.
        reuse_logs: false,
        reuse_manifest: false,
        max_open_files: MAX_OPEN_FILES,
        block_cache_capacity_bytes: N_CACHED_BLOCKS * usual.block_size,
        write_buffer_size: write_buffer_bytes,
        max_file_size: write_buffer_bytes / 2,
        ..usual
    };
    guarded(health, || DB::open(folder, options)).map_err(|error| match error {
        Error::InUse { .. } => Error::InUse {
            folder: folder.to_owned(),
        },
        other => other,
    })
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
                folder: PathBuf::new(),
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
