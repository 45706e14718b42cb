//! The thread that writes the world model to disk, and the model beside it.
//!
//! The model is under a lock that nobody holds for longer than a look or a small
//! change; what waits to be written is a set of records, so that it never grows
//! beyond the model however slow the disk is. The thread takes what has changed,
//! lets go of the lock, writes and syncs, and rests for the period.
//!
//! When writing fails the model goes on in memory; the database is opened again
//! after a rest, and everything is written anew.

use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use super::on_disk::{WorkingMemory, WorldReport};
use super::world_config::WorldConfig;
use super::world_model::WorldModel;
use crate::error::Error;

/// How often what is over is looked through when nothing happens.
const EXPIRY_PERIOD: Duration = Duration::from_secs(10);
/// Rest before a failed database is opened again.
const RETRY: Duration = Duration::from_secs(2);

/// Told why the disk does not follow, and what was found when it does again.
pub type OnTrouble = Box<dyn FnMut(&Result<WorldReport, Error>) + Send>;

/// How to run the working memory.
pub struct WorldThreadConfig {
    /// The folder.
    pub folder: PathBuf,
    /// What is remembered.
    pub world: WorldConfig,
    /// Time between two writes, at least.
    pub period: Duration,
    /// Now, nanoseconds since 1970, UTC.
    pub wall_clock: fn() -> u64,
    /// Told, on the thread, the model's version of which all is on disk.
    pub on_written: Box<dyn FnMut(u64) + Send>,
    /// Called on the thread.
    pub on_trouble: OnTrouble,
}

struct State {
    model: WorldModel,
    is_stopping: bool,
}

struct Shared {
    state: Mutex<State>,
    news: Condvar,
}

impl Shared {
    /// A panic elsewhere leaves the model usable: at worst one sighting is half told.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits while `is_idle`, at most for a time.
    fn wait(&self, at_most: Duration, is_idle: impl Fn(&State) -> bool) -> MutexGuard<'_, State> {
        let waited = self
            .news
            .wait_timeout_while(self.lock(), at_most, |state| is_idle(state));
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

/// Looks at and changes the model; clones share it.
#[derive(Clone)]
pub struct WorldHandle(Arc<Shared>);

impl WorldHandle {
    /// Looks at the model, or changes it; what changed is written soon.
    pub fn with<T>(&self, work: impl FnOnce(&mut WorldModel) -> T) -> T {
        let mut state = self.0.lock();
        let result = work(&mut state.model);
        if state.model.has_changes() {
            self.0.news.notify_one();
        }
        result
    }
}

/// Owns the thread; stops it when dropped.
pub struct WorldThread {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<Result<(), Error>>>,
}

impl WorldThread {
    /// Opens the working memory and starts its thread.
    ///
    /// # Errors
    ///
    /// Those of [`WorkingMemory::open`], and [`Error::Io`] when there is no room
    /// for a thread.
    pub fn start(config: WorldThreadConfig) -> Result<(Self, WorldHandle, WorldReport), Error> {
        let wall_ns = (config.wall_clock)();
        let (memory, model, report) = WorkingMemory::open(&config.folder, config.world, wall_ns)?;
        let shared = Arc::new(Shared {
            state: Mutex::new(State {
                model,
                is_stopping: false,
            }),
            news: Condvar::new(),
        });
        let folder = config.folder.clone();
        let mut writer = Writer {
            config,
            shared: Arc::clone(&shared),
            memory: Some(memory),
            is_failed: false,
        };
        let thread = std::thread::Builder::new()
            .name("world".to_owned())
            .spawn(move || writer.run())
            .map_err(Error::io("starting the thread of", folder))?;
        let handle = WorldHandle(Arc::clone(&shared));
        let thread = Some(thread);
        Ok((Self { shared, thread }, handle, report))
    }

    /// Writes what is not written yet, closes the database, and ends the thread.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] when the last changes could not be written.
    pub fn stop(mut self) -> Result<(), Error> {
        self.stop_and_join()
    }

    fn stop_and_join(&mut self) -> Result<(), Error> {
        let Some(thread) = self.thread.take() else {
            return Ok(());
        };
        self.shared.lock().is_stopping = true;
        self.shared.news.notify_all();
        thread.join().unwrap_or(Err(Error::Stopped))
    }
}

impl Drop for WorldThread {
    fn drop(&mut self) {
        let _ = self.stop_and_join();
    }
}

/// What runs on the thread.
struct Writer {
    config: WorldThreadConfig,
    shared: Arc<Shared>,
    /// None when writing failed and it is not open again.
    memory: Option<WorkingMemory>,
    is_failed: bool,
}

impl Writer {
    fn run(&mut self) -> Result<(), Error> {
        let shared = Arc::clone(&self.shared);
        // What was read is on disk: that is told without a change.
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
                state.model.note_all_seen();
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
            let rest = match self.memory {
                Some(_) => self.config.period,
                None => self.config.period.max(RETRY),
            };
            drop(shared.wait(rest, |state| !state.is_stopping));
        }
    }

    /// Has all on disk that changed until now; opens a failed database again.
    fn write(&mut self) -> Result<(), Error> {
        let mut memory = match self.memory.take() {
            Some(memory) => memory,
            None => self.open_again()?,
        };
        loop {
            let (writes, version, is_all) = {
                let model = &mut self.shared.lock().model;
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
        let WorldThreadConfig { folder, world, .. } = &self.config;
        let (memory, on_disk, report) =
            WorkingMemory::open(folder, *world, (self.config.wall_clock)())?;
        self.shared.lock().model.rewrite_over(&on_disk);
        self.is_failed = false;
        (self.config.on_trouble)(&Ok(report));
        Ok(memory)
    }

    /// The database was closed by the failure: its folder is free again.
    fn fail(&mut self, error: Error) {
        if !std::mem::replace(&mut self.is_failed, true) {
            (self.config.on_trouble)(&Err(error));
        }
    }
}

#[cfg(test)]
mod tests;
