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

use crate::durable_env::DurableEnv;
use crate::durable_file::DurableFile;
use crate::env_health::{EnvHealth, FileOperation, Observer};
use crate::error::Error;

/// Maximum number of open table files; at eight megabytes each, more than a robot learns.
const MAX_OPEN_FILES: usize = 256;

/// Capacity of the block cache, blocks. A block is at least as long as a record, and some records
/// are whole point clouds: the default of a thousand blocks would keep a thousand clouds in memory.
/// Blocks are rarely read twice, and the page cache of the kernel holds those that are.
const N_CACHED_BLOCKS: usize = 16;

/// Default size of the write buffer (memtable), bytes; twice the maximum table size. rusty-leveldb
/// compacts once for each table that it writes from memory. With its defaults of four and two
/// megabytes, bursts of key views outpace the compaction, and a snapshot is read from dozens of
/// tables at once.
pub const WRITE_BUFFER_BYTES: usize = 16 << 20;

/// Open LevelDB database with checksummed records.
pub struct Database {
    /// LevelDB handle; `None` if reopening failed.
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
    /// [`Error::Damaged`] when it cannot be opened for what is in its files;
    /// [`Error::Io`] and [`Error::InUse`] when that is not their fault.
    pub fn open(folder: &Path, write_buffer_bytes: usize) -> Result<Self, Error> {
        Self::open_monitored(folder, write_buffer_bytes, EnvHealth::examining())
    }

    /// Opens the database like [`Self::open`], and calls `observer` before every file operation,
    /// including those of the opening.
    ///
    /// # Errors
    ///
    /// As [`Self::open`].
    pub fn open_observed(
        folder: &Path,
        write_buffer_bytes: usize,
        observer: Observer,
    ) -> Result<Self, Error> {
        let health = EnvHealth::examining();
        health.set_observer(observer);
        Self::open_monitored(folder, write_buffer_bytes, health)
    }

    fn open_monitored(
        folder: &Path,
        write_buffer_bytes: usize,
        health: EnvHealth,
    ) -> Result<Self, Error> {
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
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when a file cannot be deleted, or [`Error::Damaged`].
    pub fn accept(&mut self) -> Result<(), Error> {
        for path in self.health.take_deferred_deletions() {
            let change = FileOperation::Delete(&path);
            let delete = || match std::fs::remove_file(&path) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
                deleted => deleted,
            };
            let deleted = self.health.perform("deleting", &path, &change, delete);
            deleted.map_err(Error::io("deleting", &path))?;
        }
        self.reopen_after_reads()
    }

    /// Applies a write batch atomically; with `is_synced` it is durable on return. After an error
    /// it may be on disk or not, until the database is reopened.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or [`Error::Damaged`].
    pub fn write(&mut self, batch: WriteBatch, is_synced: bool) -> Result<(), Error> {
        self.call(|db| db.write(batch, is_synced))?;
        self.check()
    }

    /// Compacts the tables with keys from `from` to `to`, which drops deleted records.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or [`Error::Damaged`].
    pub fn compact(&mut self, from: &[u8], to: &[u8]) -> Result<(), Error> {
        self.reopen_after_reads()?;
        self.call(|db| db.compact_range(from, to))?;
        self.check()
    }

    /// Reopens the database if anything was read, to release the snapshots.
    fn reopen_after_reads(&mut self) -> Result<(), Error> {
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
    ) -> Result<T, Error> {
        match &mut self.db {
            Some(db) => guarded(&self.health, || work(db)),
            None => Err(Error::io("using", &self.folder)(io::Error::other(
                "it could not be opened again",
            ))),
        }
    }

    /// Flushes and closes the database.
    ///
    /// # Errors
    ///
    /// [`Error::Io`]; synced batches are on disk all the same.
    pub fn close(mut self) -> Result<(), Error> {
        self.call(DB::close)
    }

    /// Reader of the present state of the database.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or [`Error::Damaged`].
    pub fn reader(&mut self) -> Result<Reader, Error> {
        self.has_been_read = true;
        let iter = self.call(DB::new_iter)?;
        Ok(Reader {
            iter,
            health: Arc::clone(&self.health),
        })
    }

    /// Creates a file beside the database that appears only whole; see [`DurableFile`].
    ///
    /// # Errors
    ///
    /// [`Error::Io`].
    pub fn create_file(&self, path: &Path) -> Result<DurableFile, Error> {
        DurableFile::create(path, Arc::clone(&self.health))
    }

    /// Error for a failure that rusty-leveldb did not report.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or, outside of the examination, [`Error::Damaged`].
    pub fn check(&self) -> Result<(), Error> {
        check(&self.health)
    }

    /// Number of detected corruptions, and the first ones as sentences.
    pub fn damages(&self) -> (u64, Vec<String>) {
        self.health.damages()
    }

    /// Records a corruption that the caller found: nothing more is written, and every further call
    /// returns [`Error::Damaged`].
    pub fn note_damage(&self, what: String) {
        self.health.note_damage(what);
    }

    /// Installs a fault-injection hook, which is called before every file operation and can
    /// make it fail; it replaces an earlier one.
    pub fn set_observer(&self, observer: Observer) {
        self.health.set_observer(observer);
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
        Error::InUse { .. } => Error::InUse {
            folder: folder.to_owned(),
        },
        other => other,
    })
}

/// Reader of records in key order.
pub struct Reader {
    iter: DBIterator,
    health: Arc<EnvHealth>,
}

impl Reader {
    /// Reads the newest value of `key`.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or, outside of the examination, [`Error::Damaged`].
    pub fn get(&mut self, key: &[u8]) -> Result<Option<Vec<u8>>, Error> {
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
    ///
    /// # Errors
    ///
    /// As [`Self::get`].
    pub fn scan(
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
    ///
    /// # Errors
    ///
    /// As [`Self::get`].
    pub fn scan_prefix(
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

/// Calls rusty-leveldb and turns its panics into errors: it asserts on input that may be damaged.
fn guarded<T>(
    health: &EnvHealth,
    call: impl FnOnce() -> rusty_leveldb::Result<T>,
) -> Result<T, Error> {
    // After a panic the database is not used again: the corruption is recorded, and
    // the caller reopens the store.
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
