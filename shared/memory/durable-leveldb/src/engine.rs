//! Engine thread: moves frozen memtables into tables, and compacts, with rusty-leveldb.
//!
//! rusty-leveldb writes and compacts in the thread of its caller. Here that is a thread of its own,
//! so that neither a write nor a read waits for it: writes go to a log and a memtable, and readers
//! read the tables themselves. Of rusty-leveldb only the making of tables, the compaction, and the
//! manifest remain; its log is not written, and it is never read from.
//!
//! A frozen memtable is written to a table and then leaves memory, and its log is deleted. The
//! deletion is durable before the next memtable is written, so the logs that a power cut leaves are
//! always the newest ones, and applying them again changes nothing.

use std::collections::{HashSet, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Weak};
use std::thread::JoinHandle;

use parking_lot::{Condvar, Mutex, MutexGuard};
use rusty_leveldb::{DB, Options, StatusCode, WriteBatch};

use crate::durable_env::{DurableEnv, ObsoleteTables, sync_folder_of};
use crate::env_health::EnvHealth;
use crate::error::Error;
use crate::log_file::LOG;
use crate::manifest::Manifest;
use crate::memtable::Memtable;
use crate::table::{Table, TableSet, delete};

/// Maximum number of table files that rusty-leveldb keeps open.
const MAX_OPEN_FILES: usize = 256;
/// Capacity of rusty-leveldb's block cache, blocks; compaction reads each block once.
const N_CACHED_BLOCKS: usize = 16;
/// Size of the batches in which a memtable is given to rusty-leveldb, bytes.
const BATCH_BYTES: usize = 1 << 20;
/// Key behind all others.
const LAST_KEY: [u8; 64] = [0xff; 64];
/// Maximum size of the frozen memtables, as a multiple of the write buffer: a writer that is faster
/// than the engine for longer waits for it.
const MAX_FROZEN_BUFFERS: usize = 8;

/// Memtable that is not written to any more.
#[derive(Debug, Clone)]
pub(crate) struct Frozen {
    pub(crate) memtable: Arc<Memtable>,
    /// Log with its records.
    pub(crate) log: PathBuf,
}

impl Frozen {
    /// `false` for a log that LevelDB wrote, and moves into a table when it opens the database.
    fn is_ours(&self) -> bool {
        self.log.extension().is_some_and(|e| e == LOG)
    }
}

/// State shared by the database and its engine thread.
#[derive(Default)]
pub(crate) struct EngineState {
    /// Memtables that are in no table yet, oldest first.
    pub(crate) frozen: VecDeque<Frozen>,
    pub(crate) tables: Arc<TableSet>,
    /// First and last key of the compactions that were asked for.
    compactions: VecDeque<(Vec<u8>, Vec<u8>)>,
    is_compacting: bool,
    stop: Option<Stop>,
    /// `true` once the thread has ended.
    has_ended: bool,
}

impl EngineState {
    /// `true` until all compactions that were asked for are done.
    fn has_compactions(&self) -> bool {
        self.is_compacting || !self.compactions.is_empty()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stop {
    /// After all frozen memtables are in tables.
    WhenDone,
    /// After the present step.
    Now,
}

/// Lock and signal of the shared state.
#[derive(Default)]
pub(crate) struct SharedState {
    state: Mutex<EngineState>,
    changed: Condvar,
}

impl SharedState {
    pub(crate) fn lock(&self) -> MutexGuard<'_, EngineState> {
        self.state.lock()
    }

    fn change<T>(&self, change: impl FnOnce(&mut EngineState) -> T) -> T {
        let changed = change(&mut self.state.lock());
        self.changed.notify_all();
        changed
    }

    /// Waits while `is_waiting` and the engine runs.
    fn wait_while(&self, is_waiting: impl Fn(&EngineState) -> bool) {
        let mut state = self.state.lock();
        let is_waiting = |state: &mut EngineState| !state.has_ended && is_waiting(state);
        self.changed.wait_while(&mut state, is_waiting);
    }
}

/// Handle of the engine thread; dropping it ends the thread after its present step.
pub(crate) struct Engine {
    shared: Arc<SharedState>,
    thread: Option<JoinHandle<()>>,
    max_frozen_bytes: usize,
}

impl Engine {
    /// Opens or creates the database for writing and starts the thread.
    ///
    /// # Errors
    ///
    /// [`Error::InUse`], [`Error::Io`] or [`Error::Damaged`].
    pub(crate) fn start(
        folder: &Path,
        write_buffer_bytes: usize,
        health: &Arc<EnvHealth>,
        shared: &Arc<SharedState>,
    ) -> Result<Self, Error> {
        let (opened, is_open) = sync_channel(1);
        let arguments = (folder.to_owned(), Arc::clone(health), Arc::clone(shared));
        let run = move || {
            let (folder, health, shared) = arguments;
            let _end = EndSignal {
                shared: &shared,
                health: &Arc::clone(&health),
            };
            // The receiver of both answers waits below.
            match EngineLoop::open(folder, write_buffer_bytes, health, &shared) {
                Ok(engine) => {
                    let _ = opened.send(Ok(()));
                    engine.run();
                }
                Err(error) => {
                    let _ = opened.send(Err(error));
                }
            }
        };
        let thread = std::thread::Builder::new()
            .name("leveldb".to_owned())
            .spawn(run)
            .map_err(Error::io("starting the thread of", folder))?;
        let engine = Self {
            shared: Arc::clone(shared),
            thread: Some(thread),
            max_frozen_bytes: MAX_FROZEN_BUFFERS * write_buffer_bytes,
        };
        let stopped = || Error::Damaged {
            what: "rusty-leveldb panicked".to_owned(),
        };
        is_open.recv().unwrap_or_else(|_| Err(stopped()))?;
        Ok(engine)
    }

    /// Gives a frozen memtable to the thread. Waits while too many are in memory.
    pub(crate) fn freeze(&self, frozen: Frozen) {
        self.shared.wait_while(|state| {
            let n_bytes = state.frozen.iter().map(|frozen| frozen.memtable.n_bytes());
            n_bytes.sum::<usize>() > self.max_frozen_bytes
        });
        self.shared.change(|state| state.frozen.push_back(frozen));
    }

    /// Asks for the compaction of the tables with keys from `from` to `to`.
    pub(crate) fn compact(&self, from: &[u8], to: &[u8]) {
        let range = (from.to_vec(), to.to_vec());
        self.shared
            .change(|state| state.compactions.push_back(range));
    }

    /// `true` until all compactions that were asked for are done.
    pub(crate) fn is_compacting(&self) -> bool {
        let state = self.shared.lock();
        !state.has_ended && state.has_compactions()
    }

    /// Waits until everything that was asked for is done.
    pub(crate) fn settle(&self) {
        self.shared
            .wait_while(|state| state.has_compactions() || !state.frozen.is_empty());
    }

    /// Ends the thread when all frozen memtables are in tables.
    pub(crate) fn close(mut self) {
        self.end(Stop::WhenDone);
    }

    fn end(&mut self, stop: Stop) {
        let Some(thread) = self.thread.take() else {
            return;
        };
        self.shared.change(|state| state.stop = Some(stop));
        // A panic in the thread has been recorded by the health monitor.
        let _ = thread.join();
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.end(Stop::Now);
    }
}

/// Signal of the end of the thread, also by a panic.
struct EndSignal<'a> {
    shared: &'a SharedState,
    health: &'a EnvHealth,
}

impl Drop for EndSignal<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.health
                .note_damage("the engine thread panicked".to_owned());
        }
        self.shared.change(|state| state.has_ended = true);
    }
}

/// Work of the engine thread.
enum EngineStep {
    Write(Frozen),
    Compact(Vec<u8>, Vec<u8>),
    Stop,
}

/// Loop of the engine thread, the owner of rusty-leveldb.
struct EngineLoop<'a> {
    db: DB,
    folder: PathBuf,
    health: Arc<EnvHealth>,
    shared: &'a SharedState,
    obsolete: ObsoleteTables,
    /// Replaced tables that may still be read.
    replaced: Vec<Weak<Table>>,
}

impl<'a> EngineLoop<'a> {
    fn open(
        folder: PathBuf,
        write_buffer_bytes: usize,
        health: Arc<EnvHealth>,
        shared: &'a SharedState,
    ) -> Result<Self, Error> {
        let obsolete = ObsoleteTables::default();
        let env = DurableEnv::new(Arc::clone(&health), Arc::clone(&obsolete));
        let usual = Options::default();
        let options = Options {
            env: Rc::new(Box::new(env)),
            // With either, writes after a truncated log are lost at the next opening.
            reuse_logs: false,
            reuse_manifest: false,
            max_open_files: MAX_OPEN_FILES,
            block_cache_capacity_bytes: N_CACHED_BLOCKS * usual.block_size,
            // A memtable becomes a table only when all of it was written.
            write_buffer_size: 4 * write_buffer_bytes,
            max_file_size: write_buffer_bytes / 2,
            ..usual
        };
        let db = guarded(&health, || DB::open(&folder, options));
        let db = db.map_err(|error| match error {
            Error::InUse { .. } => Error::InUse {
                folder: folder.clone(),
            },
            other => other,
        })?;
        let mut engine = Self {
            db,
            folder,
            health,
            shared,
            obsolete,
            replaced: Vec::new(),
        };
        engine.publish()?;
        // LevelDB's own logs are in tables now.
        shared.change(|state| state.frozen.retain(Frozen::is_ours));
        Ok(engine)
    }

    /// Works until it is stopped, or until the health monitor has a failure.
    fn run(mut self) {
        loop {
            let done = match self.next_step() {
                EngineStep::Write(frozen) => self.write(&frozen),
                EngineStep::Compact(from, to) => self.compact(&from, &to),
                EngineStep::Stop => break,
            };
            if done.is_err() {
                return;
            }
        }
        // Whatever fails is recorded by the health monitor.
        let _ = guarded(&self.health, || self.db.close());
    }

    fn next_step(&self) -> EngineStep {
        let mut state = self.shared.state.lock();
        loop {
            if state.stop == Some(Stop::Now) {
                return EngineStep::Stop;
            }
            if let Some(frozen) = state.frozen.front() {
                return EngineStep::Write(frozen.clone());
            }
            if state.stop.is_some() {
                return EngineStep::Stop;
            }
            if let Some((from, to)) = state.compactions.pop_front() {
                state.is_compacting = true;
                return EngineStep::Compact(from, to);
            }
            self.shared.changed.wait(&mut state);
        }
    }

    /// Writes the oldest memtable to a table, and deletes its log.
    fn write(&mut self, frozen: &Frozen) -> Result<(), Error> {
        let mut batch = WriteBatch::default();
        let mut n_bytes = 0;
        for (key, value) in frozen.memtable.range_from(&[]) {
            match value {
                Some(value) => batch.put(key, value),
                None => batch.delete(key),
            }
            n_bytes += key.len() + value.as_ref().map_or(0, Vec::len);
            if n_bytes > BATCH_BYTES {
                n_bytes = 0;
                self.add(std::mem::take(&mut batch))?;
            }
        }
        self.add(batch)?;
        // Compacting no keys writes the memtable of rusty-leveldb.
        self.compact_tables(&LAST_KEY, &LAST_KEY)?;
        self.publish()?;
        let deleted = delete(&frozen.log, &self.health);
        let deleted = deleted.and_then(|()| sync_folder_of(&frozen.log, &self.health));
        deleted.map_err(Error::io("deleting", &frozen.log))?;
        self.shared.change(|state| state.frozen.pop_front());
        Ok(())
    }

    fn add(&mut self, batch: WriteBatch) -> Result<(), Error> {
        let is_synced = false;
        guarded(&self.health, || self.db.write(batch, is_synced))?;
        self.health.check()
    }

    fn compact(&mut self, from: &[u8], to: &[u8]) -> Result<(), Error> {
        self.compact_tables(from, to)?;
        self.publish()?;
        self.shared.change(|state| state.is_compacting = false);
        Ok(())
    }

    fn compact_tables(&mut self, from: &[u8], to: &[u8]) -> Result<(), Error> {
        guarded(&self.health, || self.db.compact_range(from, to))?;
        self.health.check()
    }

    /// Shows the present tables to readers, and deletes those that nobody reads any more.
    fn publish(&mut self) -> Result<(), Error> {
        let earlier = Arc::clone(&self.shared.lock().tables);
        let manifest = Manifest::read(&self.folder, &self.health)?.unwrap_or_default();
        let tables = TableSet::of(manifest, &self.folder, &earlier, &self.health);
        self.health.check()?;
        let current: HashSet<u64> = tables.tables().map(|table| table.metadata.number).collect();
        let is_current = |table: &&Arc<Table>| current.contains(&table.metadata.number);
        for table in earlier.tables().filter(|table| !is_current(table)) {
            table.set_replaced(&self.health);
            self.replaced.push(Arc::downgrade(table));
        }
        self.shared.change(|state| state.tables = Arc::new(tables));
        // Those that only the earlier tables held are deleted here.
        drop(earlier);
        self.replaced.retain(|table| table.strong_count() > 0);
        self.delete_unknown()?;
        self.health.check()
    }

    /// Deletes the obsolete tables that were never shown to readers: those of a crash, and those
    /// that were made and merged in one step.
    fn delete_unknown(&mut self) -> Result<(), Error> {
        let obsolete = std::mem::take(&mut *self.obsolete.lock());
        for path in obsolete {
            let is_read = |table: &Weak<Table>| table.upgrade().is_some_and(|t| *t.path == *path);
            if path.exists() && !self.replaced.iter().any(is_read) {
                delete(&path, &self.health).map_err(Error::io("deleting", path))?;
            }
        }
        Ok(())
    }
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
