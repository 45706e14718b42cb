//! Writer thread of the working memory, and the shared world model.
//!
//! The model is behind a lock that is held only for short queries and changes. Unwritten changes
//! are a set of records, which is never larger than the model, however slow the disk. The thread
//! takes the changes, releases the lock, writes and syncs, and sleeps for the rest of the period.
//!
//! If writing fails, the model continues in memory; the database is reopened after a pause and
//! written completely.

use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use parking_lot::{Condvar, Mutex, MutexGuard};

use crate::error::{Error, StorageError};
use crate::working_memory::{WorkingMemory, WorldReport};
use crate::world_config::WorldConfig;
use crate::world_model::WorldModel;

/// Period of the removal of expired items without other changes.
const EXPIRY_PERIOD: Duration = Duration::from_secs(10);
/// Pause before a failed database is reopened.
const RETRY: Duration = Duration::from_secs(2);

/// Callback with a write error, and with the report after the database was reopened.
pub type OnTrouble = Box<dyn FnMut(&Result<WorldReport, Error>) + Send>;

/// Configuration of the writer thread.
pub struct WorldThreadConfig {
    /// Folder of the working memory.
    pub folder: PathBuf,
    /// Configuration of the world model.
    pub world: WorldConfig,
    /// Minimum time between two writes to disk.
    pub period: Duration,
    /// Wall clock: nanoseconds since 1970, UTC.
    pub wall_clock: fn() -> u64,
    /// Callback with the model version that is on disk, called on the thread.
    pub on_written: Box<dyn FnMut(u64) + Send>,
    /// Callback for write errors and recoveries, called on the thread.
    pub on_trouble: OnTrouble,
}

impl WorldThreadConfig {
    /// Opens the working memory. One that cannot be written is loaded, and written as soon as it
    /// can be.
    fn open(
        &self,
        wall_ns: u64,
    ) -> Result<(Option<WorkingMemory>, WorldModel, WorldReport), Error> {
        let error = match WorkingMemory::open(&self.folder, self.world, wall_ns) {
            Ok((memory, model, report)) => return Ok((Some(memory), model, report)),
            Err(error) => error,
        };
        if !matches!(error, Error::Storage(StorageError::Io(_))) {
            return Err(error);
        }
        match WorkingMemory::load(&self.folder, self.world, wall_ns) {
            Ok((model, report)) => Ok((None, model, report)),
            Err(_) => Err(error),
        }
    }
}

struct GuardedModel {
    model: WorldModel,
    /// Minimum time between two writes to disk.
    period: Duration,
    is_stopping: bool,
}

struct SharedModel {
    state: Mutex<GuardedModel>,
    changed: Condvar,
}

impl SharedModel {
    /// Locks the model once `is_idle` is false or the time is over.
    fn wait(
        &self,
        at_most: Duration,
        is_idle: impl Fn(&GuardedModel) -> bool,
    ) -> MutexGuard<'_, GuardedModel> {
        let mut state = self.state.lock();
        self.changed
            .wait_while_for(&mut state, |state| is_idle(state), at_most);
        state
    }
}

/// Cloneable handle of the shared world model.
#[derive(Clone)]
pub struct WorldHandle(Arc<SharedModel>);

impl WorldHandle {
    /// Runs a query or a change on the locked model; changes are written soon.
    pub fn with<T>(&self, work: impl FnOnce(&mut WorldModel) -> T) -> T {
        let mut state = self.0.state.lock();
        let result = work(&mut state.model);
        if state.model.has_changes() {
            self.0.changed.notify_one();
        }
        result
    }

    /// Replaces the configuration of the model, and the minimum time between two writes.
    pub fn set_config(&self, config: WorldConfig, period: Duration) {
        let mut state = self.0.state.lock();
        state.model.set_config(config);
        state.period = period;
    }
}

/// Owner of the writer thread; dropping it stops the thread.
pub struct WorldThread {
    shared: Arc<SharedModel>,
    thread: Option<JoinHandle<Result<(), Error>>>,
}

impl WorldThread {
    /// Opens the working memory and starts its thread.
    ///
    /// # Errors
    ///
    /// Those of [`WorkingMemory::open`] when it cannot be loaded either, and [`StorageError::Io`]
    /// when there is no room for a thread.
    pub fn start(config: WorldThreadConfig) -> Result<(Self, WorldHandle, WorldReport), Error> {
        let wall_ns = (config.wall_clock)();
        let (memory, model, report) = config.open(wall_ns)?;
        let shared = Arc::new(SharedModel {
            state: Mutex::new(GuardedModel {
                model,
                period: config.period,
                is_stopping: false,
            }),
            changed: Condvar::new(),
        });
        let folder = config.folder.clone();
        let mut writer = Writer {
            config,
            shared: Arc::clone(&shared),
            memory,
            is_failed: false,
        };
        let thread = std::thread::Builder::new()
            .name("world".to_owned())
            .spawn(move || writer.run())
            .map_err(StorageError::io("starting the thread of", folder))?;
        let handle = WorldHandle(Arc::clone(&shared));
        let thread = Some(thread);
        Ok((Self { shared, thread }, handle, report))
    }

    /// Writes all changes, closes the database, and ends the thread.
    ///
    /// # Errors
    ///
    /// [`StorageError::Io`] when the last changes could not be written.
    pub fn stop(mut self) -> Result<(), Error> {
        self.stop_and_join()
    }

    fn stop_and_join(&mut self) -> Result<(), Error> {
        let Some(thread) = self.thread.take() else {
            return Ok(());
        };
        self.shared.state.lock().is_stopping = true;
        self.shared.changed.notify_all();
        thread.join().unwrap_or(Err(Error::Stopped))
    }
}

impl Drop for WorldThread {
    fn drop(&mut self) {
        let _ = self.stop_and_join();
    }
}

/// Loop of the writer thread.
struct Writer {
    config: WorldThreadConfig,
    shared: Arc<SharedModel>,
    /// Database; `None` after a failed write, until it is reopened.
    memory: Option<WorkingMemory>,
    is_failed: bool,
}

impl Writer {
    fn run(&mut self) -> Result<(), Error> {
        let shared = Arc::clone(&self.shared);
        // The loaded model is on disk: report its version without a change.
        if let Err(error) = self.write() {
            self.fail(error);
        }
        loop {
            let mut state = shared.wait(EXPIRY_PERIOD, |state| {
                !state.is_stopping && !state.model.has_changes()
            });
            let now_ns = (self.config.wall_clock)();
            state.model.expire(now_ns);
            let is_stopping = state.is_stopping;
            if is_stopping {
                state.model.mark_present_dirty();
            }
            drop(state);
            let written = self.write();
            if is_stopping {
                written?;
                return self.memory.take().map_or(Ok(()), WorkingMemory::close);
            }
            if let Err(error) = written {
                self.fail(error);
            }
            let period = shared.state.lock().period;
            let rest = match self.memory {
                Some(_) => period,
                None => period.max(RETRY),
            };
            drop(shared.wait(rest, |state| !state.is_stopping));
        }
    }

    /// Writes all present changes; reopens a failed database.
    fn write(&mut self) -> Result<(), Error> {
        let mut memory = match self.memory.take() {
            Some(memory) => memory,
            None => self.open_again()?,
        };
        loop {
            let (writes, version, is_all) = {
                let model = &mut self.shared.state.lock().model;
                let writes = model.take_writes();
                (writes, model.version(), !model.has_changes())
            };
            if !writes.is_empty() {
                memory.write(writes)?;
            }
            if is_all {
                (self.config.on_written)(version);
                self.memory = Some(memory);
                return Ok(());
            }
        }
    }

    fn open_again(&mut self) -> Result<WorkingMemory, Error> {
        let world = self.shared.state.lock().model.config;
        let wall_ns = (self.config.wall_clock)();
        let (memory, on_disk, report) = WorkingMemory::open(&self.config.folder, world, wall_ns)?;
        self.shared.state.lock().model.rewrite_over(&on_disk);
        self.is_failed = false;
        (self.config.on_trouble)(&Ok(report));
        Ok(memory)
    }

    /// Reports the first of a series of failures. The failed database is closed, so that its folder
    /// is unlocked.
    fn fail(&mut self, error: Error) {
        if !std::mem::replace(&mut self.is_failed, true) {
            (self.config.on_trouble)(&Err(error));
        }
    }
}

#[cfg(test)]
mod tests;
