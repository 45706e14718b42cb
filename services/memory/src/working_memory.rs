//! Working memory of the process: the world model, its event notifications, and its
//! progress on disk.

use crate::config::Config;
use crate::health_conditions::{Condition, HealthConditions, Store};
use message::SceneTime;
use parking_lot::Mutex;
use service::{Context, Failure, wall_clock_ns};
use std::sync::Arc;
use tokio::sync::watch;
use working_memory::{
    OnTrouble, WorldHandle, WorldModel, WorldReport, WorldThread, WorldThreadConfig,
};

/// World model, shared by its updater and its readers.
pub(crate) struct WorkingMemory {
    handle: WorldHandle,
    newest_event: watch::Sender<u64>,
    /// Times of the newest scene; `None` before the first one.
    scene_time: Mutex<Option<SceneTime>>,
    written: watch::Receiver<u64>,
}

/// Current wall-clock time, nanoseconds since 1970 (UTC).
pub(crate) fn now_ns() -> u64 {
    wall_clock_ns().max(0) as u64
}

impl WorkingMemory {
    /// Opens the working memory and starts the thread that writes it.
    ///
    /// # Errors
    /// When its folder is in use or cannot be written.
    pub(crate) fn start(
        context: &Context,
        config: &Config,
        health: &Arc<HealthConditions>,
    ) -> Result<(WorldThread, Self), Failure> {
        let (on_disk, written) = watch::channel(0);
        let (thread, handle, report) = WorldThread::start(WorldThreadConfig {
            folder: context.home.working_memory(),
            world: config.world,
            period: config.world_period,
            wall_clock: now_ns,
            on_written: Box::new(move |version| {
                on_disk.send_replace(version);
            }),
            on_trouble: on_trouble(health.clone()),
        })
        .map_err(Failure::general)?;
        log_report(health, &report);
        let newest_event = handle.with(|model| model.newest_event());
        let world = Self {
            handle,
            newest_event: watch::channel(newest_event).0,
            scene_time: Mutex::new(None),
            written,
        };
        Ok((thread, world))
    }

    /// Replaces the configuration of the model and the period of its writes.
    pub(crate) fn set_config(&self, config: &Config) {
        self.handle.set_config(config.world, config.world_period);
    }

    /// Reads or changes the model under its lock; the work must be short.
    pub(crate) fn with<T>(&self, work: impl FnOnce(&mut WorldModel) -> T) -> T {
        let (result, newest) = self
            .handle
            .with(|model| (work(model), model.newest_event()));
        self.newest_event.send_if_modified(|known| {
            let is_news = *known != newest;
            *known = newest;
            is_news
        });
        result
    }

    /// Sets the times of the newest scene.
    pub(crate) fn set_scene_time(&self, time: SceneTime) {
        *self.scene_time.lock() = Some(time);
    }

    /// Times of the newest scene; `None` before the first one.
    pub(crate) fn scene_time(&self) -> Option<SceneTime> {
        *self.scene_time.lock()
    }

    /// Watch channel with the sequence number of the newest event.
    pub(crate) fn events(&self) -> watch::Receiver<u64> {
        self.newest_event.subscribe()
    }

    /// Notification of writes: the version of the model that is on disk.
    pub(crate) fn written(&self) -> watch::Receiver<u64> {
        self.written.clone()
    }
}

/// Logs the result of opening the working memory; a loss degrades the health.
fn log_report(health: &HealthConditions, report: &WorldReport) {
    let condition = if report.is_loss() {
        tracing::error!("{report}");
        Condition::degraded(report.to_string())
    } else {
        tracing::info!("{report}");
        Condition::default()
    };
    health.set(Store::Working, condition);
}

/// Handler of write failures: the health is degraded while they last.
fn on_trouble(health: Arc<HealthConditions>) -> OnTrouble {
    Box::new(move |result| match result {
        Err(error) => {
            let note = format!("the working memory is not on disk: {error}");
            tracing::error!("{note}");
            health.set(Store::Working, Condition::degraded(note));
        }
        Ok(report) => {
            tracing::info!("the working memory is on disk again");
            log_report(&health, report);
        }
    })
}
