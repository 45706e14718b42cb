//! Database: a log and a memtable for writing, over the tables of LevelDB.
//!
//! A write is appended to the log, synced, and kept in a memtable. A full memtable is frozen, and
//! the [engine thread](crate::engine) moves it into tables and compacts these. Neither a write nor a
//! read waits for that.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::durable_file::DurableFile;
use crate::engine::{Engine, EngineState, Frozen, SharedState};
use crate::env_health::{EnvHealth, Observer};
use crate::error::Error;
use crate::log_file::{LOG, LogFile};
use crate::manifest::{Manifest, numbered_files};
use crate::memtable::Memtable;
use crate::raw_log::visit_log;
use crate::reader::Reader;
use crate::table::TableSet;
use crate::verified_files::read_log;
use crate::write_batch::WriteBatch;

/// Default size of the write buffer (memtable), bytes; twice the maximum table size. LevelDB
/// compacts once for each table that it writes from memory. With its defaults of four and two
/// megabytes, bursts of key views outpace the compaction, and a snapshot is read from dozens of
/// tables at once.
pub const WRITE_BUFFER_BYTES: usize = 16 << 20;

/// Extension of LevelDB's own logs, which are read and not written.
const LEVELDB_LOG: &str = "log";

/// Open LevelDB database with checksummed records.
pub struct Database {
    folder: PathBuf,
    write_buffer_bytes: usize,
    health: Arc<EnvHealth>,
    shared: Arc<SharedState>,
    /// Memtable that is written to.
    active: Arc<Memtable>,
    /// Log of the active memtable; created by the first write.
    log: Option<LogFile>,
    next_log: u64,
    /// Sequence number of the last record.
    sequence: u64,
    /// Engine thread; `None` during the examination.
    engine: Option<Engine>,
}

impl Database {
    /// Opens the database in `folder` for examination: it is only read, nothing in the folder is
    /// changed, and corruption is recorded instead of being fatal. An empty or missing folder is an
    /// empty database. [`Self::accept`] opens it for writing.
    ///
    /// # Errors
    ///
    /// [`Error::Damaged`] when it cannot be opened for what is in its files;
    /// [`Error::Io`] when that is not their fault.
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
        let mut database = Self {
            folder: folder.to_owned(),
            write_buffer_bytes,
            health: Arc::new(health),
            shared: Arc::default(),
            active: Arc::default(),
            log: None,
            next_log: 1,
            sequence: 0,
            engine: None,
        };
        let health = &database.health;
        if let Some(manifest) = Manifest::read(folder, health)? {
            database.sequence = manifest.last_sequence;
            database.load_logs(LEVELDB_LOG, |number| manifest.has_log(number))?;
            let tables = TableSet::of(manifest, folder, &TableSet::default(), &database.health);
            database.shared.lock().tables = Arc::new(tables);
        }
        database.load_logs(LOG, |_| true)?;
        match database.health.failure() {
            Some(failure) => Err(failure.into()),
            None => Ok(database),
        }
    }

    /// Loads the logs with an extension, in order, each into a memtable.
    fn load_logs(&mut self, extension: &str, is_due: impl Fn(u64) -> bool) -> Result<(), Error> {
        if !self.folder.exists() {
            return Ok(());
        }
        let logs = numbered_files(&self.folder, extension);
        let logs = self.health.noted(&self.folder, logs);
        for (number, path) in logs.map_err(Error::io("listing", &self.folder))? {
            if extension == LOG {
                self.next_log = self.next_log.max(number + 1);
            }
            if !is_due(number) {
                continue;
            }
            // A failure is recorded by the health monitor.
            let log = read_log(&path, &self.health).unwrap_or_default();
            let mut memtable = Memtable::default();
            visit_log(&log, |record| {
                self.sequence = self.sequence.max(record.sequence);
                memtable.insert((record.key.to_vec(), record.value.map(<[u8]>::to_vec)));
            });
            let memtable = Arc::new(memtable);
            let mut state = self.shared.lock();
            state.frozen.push_back(Frozen {
                memtable,
                log: path,
            });
        }
        Ok(())
    }

    /// Ends the examination: from now on the database can be written, and corruption stops all
    /// changes.
    ///
    /// # Errors
    ///
    /// [`Error::InUse`], [`Error::Io`] or [`Error::Damaged`].
    pub fn accept(&mut self) -> Result<(), Error> {
        self.health.end_examination();
        self.health.check()?;
        let engine = Engine::start(
            &self.folder,
            self.write_buffer_bytes,
            &self.health,
            &self.shared,
        )?;
        self.engine = Some(engine);
        Ok(())
    }

    /// Applies a write batch atomically; with `is_synced` it is durable on return. After an error
    /// it may be on disk or not, until the database is opened again.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or [`Error::Damaged`].
    pub fn write(&mut self, batch: WriteBatch, is_synced: bool) -> Result<(), Error> {
        self.check()?;
        if self.active.n_bytes() >= self.write_buffer_bytes {
            self.freeze()?;
        }
        let written = self.append(&batch, is_synced);
        written.map_err(|error| self.error_of(error))?;
        let active = Arc::make_mut(&mut self.active);
        for record in batch.into_records() {
            active.insert(record);
        }
        Ok(())
    }

    fn append(&mut self, batch: &WriteBatch, is_synced: bool) -> std::io::Result<()> {
        let log = match &mut self.log {
            Some(log) => log,
            none => {
                let path = self.folder.join(format!("{:06}.{LOG}", self.next_log));
                self.next_log += 1;
                none.insert(LogFile::create(&path, &self.health)?)
            }
        };
        log.append(&batch.encode(self.sequence + 1))?;
        self.sequence += batch.len() as u64;
        if is_synced { log.sync() } else { Ok(()) }
    }

    /// Freezes the active memtable and gives it to the engine.
    fn freeze(&mut self) -> Result<(), Error> {
        let (Some(mut log), Some(engine)) = (self.log.take(), &self.engine) else {
            return Ok(());
        };
        let path = log.path();
        let synced = log.sync();
        drop(log);
        synced.map_err(|error| self.error_of(error))?;
        engine.freeze(Frozen {
            memtable: std::mem::take(&mut self.active),
            log: path,
        });
        self.check()
    }

    /// Starts the compaction of the tables with keys from `from` to `to`, which drops deleted
    /// records. It goes on in the engine thread.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or [`Error::Damaged`] of an earlier step.
    pub fn compact(&mut self, from: &[u8], to: &[u8]) -> Result<(), Error> {
        self.freeze()?;
        if let Some(engine) = &self.engine {
            engine.compact(from, to);
        }
        self.check()
    }

    /// `true` until the compactions that were started have ended.
    pub fn is_compacting(&self) -> bool {
        self.engine.as_ref().is_some_and(Engine::is_compacting)
    }

    /// Waits until the engine thread has nothing to do.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or [`Error::Damaged`].
    pub fn settle(&self) -> Result<(), Error> {
        if let Some(engine) = &self.engine {
            engine.settle();
        }
        self.check()
    }

    /// Writes all records to tables and closes the database.
    ///
    /// # Errors
    ///
    /// [`Error::Io`]; synced batches are on disk all the same.
    pub fn close(mut self) -> Result<(), Error> {
        self.freeze()?;
        if let Some(engine) = self.engine.take() {
            engine.close();
        }
        self.check()
    }

    /// Reader of the present state of the database.
    pub fn reader(&self) -> Reader {
        let (memtables, tables) = self.state();
        Reader::new(memtables, tables, Arc::clone(&self.health))
    }

    /// Reader of the present state with a health monitor of its own, for another thread: what it
    /// finds damaged is recorded as in an examination, and stops no writes. Once the database has
    /// been closed and opened again, its reads may fail with [`Error::Io`].
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or [`Error::Damaged`].
    pub fn snapshot(&mut self) -> Result<Reader, Error> {
        self.freeze()?;
        let (memtables, tables) = self.state();
        let health = Arc::new(EnvHealth::of_snapshot());
        Ok(Reader::new(memtables, tables, health))
    }

    /// Memtables, the newest first, and tables.
    fn state(&self) -> (Vec<Arc<Memtable>>, Arc<TableSet>) {
        let EngineState { frozen, tables, .. } = &*self.shared.lock();
        let frozen = frozen.iter().rev();
        let frozen = frozen.map(|frozen| Arc::clone(&frozen.memtable));
        let memtables = std::iter::once(Arc::clone(&self.active)).chain(frozen);
        let memtables = memtables.filter(|memtable| !memtable.is_empty());
        (memtables.collect(), Arc::clone(tables))
    }

    /// Creates a file beside the database that appears only whole; see [`DurableFile`].
    ///
    /// # Errors
    ///
    /// [`Error::Io`].
    pub fn create_file(&self, path: &Path) -> Result<DurableFile, Error> {
        DurableFile::create(path, Arc::clone(&self.health))
    }

    /// Error of an earlier step of the engine thread, or of a read.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] or, outside of the examination, [`Error::Damaged`].
    pub fn check(&self) -> Result<(), Error> {
        self.health.check()
    }

    /// Error of a failed write, as the health monitor has recorded it.
    fn error_of(&self, error: std::io::Error) -> Error {
        match self.health.check() {
            Err(recorded) => recorded,
            Ok(()) => Error::io("writing", &self.folder)(error),
        }
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
