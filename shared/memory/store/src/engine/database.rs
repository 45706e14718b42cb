//! Storage engine: rusty-leveldb with reported errors, caught panics, and correct reads.
//!
//! It is read by iterator only. Its `get` is wrong in two cases: it stops at the deletion of the
//! next greater key, and it misses the last written key at the end of a block.
//!
//! Every iterator takes a snapshot that is never released: after the first read, compaction keeps
//! every version of every record, and deleted records stay on disk for ever. The database is
//! therefore reopened after reads, before the next compaction.

use std::io;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use rusty_leveldb::{DB, DBIterator, LdbIterator, Options, StatusCode, WriteBatch};

use crate::engine::durable_env::DurableEnv;
use crate::engine::env_health::{EnvHealth, FileOperation};
use crate::engine::storage_error::StorageError;

/// Maximum number of open table files; at eight megabytes each, more than a robot learns.
const MAX_OPEN_FILES: usize = 256;

/// Capacity of the block cache, blocks. A block is at least as long as a record, and some records
/// are whole point clouds: the default of a thousand blocks would keep a thousand clouds in memory.
/// Blocks are rarely read twice, and the page cache of the kernel holds those that are.
const N_CACHED_BLOCKS: usize = 16;

/// Default size of the write buffer (memtable), bytes; twice the maximum table size. rusty-leveldb
/// compacts once for each table that it writes from memory. With its defaults of four and two
/// megabytes, bursts of key views outpace the compaction, and a snapshot is read from dozens of
/// tables at once. Tests use a smaller buffer.
pub const WRITE_BUFFER_BYTES: usize = if cfg!(test) { 4 << 20 } else { 16 << 20 };

/// Open database.
pub(crate) struct Database {
    /// Database handle; `None` if reopening failed.
    db: Option<DB>,
    folder: PathBuf,
    write_buffer_bytes: usize,
    /// `true` if anything was read since the database was opened.
    has_been_read: bool,
    health: Arc<EnvHealth>,
}

impl Database {
    /// Opens or creates the database in `folder` for examination: corruption is recorded instead of
    /// being fatal, and no file is deleted before [`Self::accept`].
    ///
    /// # Errors
    ///
    /// [`StorageError::Damaged`] when it cannot be opened for what is in its files;
    /// [`Error::Io`] and [`StorageError::InUse`] when that is not their fault.
    pub(crate) fn open(folder: &Path, write_buffer_bytes: usize) -> Result<Self, StorageError> {
        Self::open_watched(folder, write_buffer_bytes, EnvHealth::examining())
    }

    pub(crate) fn open_watched(
        folder: &Path,
        write_buffer_bytes: usize,
        health: EnvHealth,
    ) -> Result<Self, StorageError> {
        let health = Arc::new(health);
        Ok(Self {
            db: Some(open_database(folder, write_buffer_bytes, &health)?),
            folder: folder.to_owned(),
            write_buffer_bytes,
            has_been_read: false,
            health,
        })
    }

    /// Ends the examination: performs the deferred deletions. From now on corruption stops all
    /// changes, and compaction drops deleted records.
    pub(crate) fn accept(&mut self) -> Result<(), StorageError> {
        for path in self.health.take_deferred_deletions() {
            let change = FileOperation::Delete(&path);
            let delete = || match std::fs::remove_file(&path) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
                deleted => deleted,
            };
            let deleted = self.health.perform("deleting", &path, &change, delete);
            deleted.map_err(StorageError::io("deleting", &path))?;
        }
        self.reopen_after_reads()
    }

    /// Applies a write batch atomically; with `is_synced` it is durable on return. After an error
    /// it may be on disk or not, until the database is reopened.
    pub(crate) fn write(&mut self, batch: WriteBatch, is_synced: bool) -> Result<(), StorageError> {
        self.call(|db| db.write(batch, is_synced))?;
        self.check()
    }

    /// Compacts the tables with keys from `from` to `to`, which drops deleted records.
    pub(crate) fn compact(&mut self, from: &[u8], to: &[u8]) -> Result<(), StorageError> {
        self.reopen_after_reads()?;
        self.call(|db| db.compact_range(from, to))?;
        self.check()
    }

    /// Reopens the database if anything was read, to release the snapshots.
    fn reopen_after_reads(&mut self) -> Result<(), StorageError> {
        if !self.has_been_read {
            return Ok(());
        }
        self.call(DB::close)?;
        self.db = None;
        let opened = open_database(&self.folder, self.write_buffer_bytes, &self.health)?;
        self.db = Some(opened);
        self.has_been_read = false;
        Ok(())
    }

    fn call<T>(
        &mut self,
        work: impl FnOnce(&mut DB) -> rusty_leveldb::Result<T>,
    ) -> Result<T, StorageError> {
        match &mut self.db {
            Some(db) => guarded(&self.health, || work(db)),
            None => Err(StorageError::io("using", &self.folder)(io::Error::other(
                "it could not be opened again",
            ))),
        }
    }

    /// Flushes and closes the database.
    pub(crate) fn close(mut self) -> Result<(), StorageError> {
        self.call(DB::close)
    }

    /// Reader of the present state of the database.
    pub(crate) fn reader(&mut self) -> Result<Reader, StorageError> {
        self.has_been_read = true;
        let iter = self.call(DB::new_iter)?;
        Ok(Reader {
            iter,
            health: Arc::clone(&self.health),
        })
    }

    /// Error for a failure that rusty-leveldb did not report.
    pub(crate) fn check(&self) -> Result<(), StorageError> {
        check(&self.health)
    }

    /// Number of detected corruptions, and the first ones as sentences.
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
) -> Result<DB, StorageError> {
    let usual = Options::default();
    let options = Options {
        env: Rc::new(Box::new(DurableEnv::new(Arc::clone(health)))),
        // With either, writes after a truncated log are lost at the next opening.
        reuse_logs: false,
        reuse_manifest: false,
        max_open_files: MAX_OPEN_FILES,
        block_cache_capacity_bytes: N_CACHED_BLOCKS * usual.block_size,
        write_buffer_size: write_buffer_bytes,
        max_file_size: write_buffer_bytes / 2,
        ..usual
    };
    guarded(health, || DB::open(folder, options)).map_err(|error| match error {
        StorageError::InUse { .. } => StorageError::InUse {
            folder: folder.to_owned(),
        },
        other => other,
    })
}

/// Reader of records in key order.
pub(crate) struct Reader {
    iter: DBIterator,
    health: Arc<EnvHealth>,
}

impl Reader {
    /// Value of `key`.
    pub(crate) fn get(&mut self, key: &[u8]) -> Result<Option<Vec<u8>>, StorageError> {
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
    ) -> Result<(), StorageError> {
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
    ) -> Result<(), StorageError> {
        self.scan(prefix, |key, value| {
            if !key.starts_with(prefix) {
                return ControlFlow::Break(());
            }
            visit(key, value);
            ControlFlow::Continue(())
        })
    }
}

fn check(health: &EnvHealth) -> Result<(), StorageError> {
    if let Some(failure) = health.failure() {
        return Err(failure.into());
    }
    if health.n_damages() > 0 && !health.is_examining() {
        return Err(StorageError::Damaged {
            what: health.damages().1.join("; "),
        });
    }
    Ok(())
}

/// Calls rusty-leveldb and turns its panics into errors: it asserts on input that may be damaged.
fn guarded<T>(
    health: &EnvHealth,
    call: impl FnOnce() -> rusty_leveldb::Result<T>,
) -> Result<T, StorageError> {
    // After a panic the database is not used again: the corruption is recorded, and
    // the caller reopens the store.
    let what = match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(value)) => return Ok(value),
        Ok(Err(status)) if status.code == StatusCode::LockError => {
            return Err(StorageError::InUse {
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
    Err(StorageError::Damaged { what })
}
