//! The working memory as the process has it: the model, who waits for its events,
//! and how far it is on disk.

use crate::config::Config;
use message::ProcessState;
use service::{Context, Failure, HealthBoard, exit_code, wall_clock_ns};
use std::sync::{Arc, Mutex, PoisonError};
use store::working::{
    OnTrouble, WorldHandle, WorldModel, WorldReport, WorldThread, WorldThreadConfig,
};
use tokio::sync::watch;

/// The model, shared by who feeds it and who asks it.
pub(crate) struct World {
    handle: WorldHandle,
    newest_event: watch::Sender<u64>,
    written: watch::Receiver<u64>,
}

/// Now, nanoseconds since 1970.
pub(crate) fn now_ns() -> u64 {
    wall_clock_ns().max(0) as u64
}

impl World {
    /// Opens the working memory and starts the thread that writes it.
    ///
    /// # Errors
    /// When its folder is in use or can not be written.
    pub(crate) fn start(
        context: &Context,
        config: &Config,
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
            on_trouble: on_trouble(context.health.clone()),
        })
        .map_err(|error| Failure::new(exit_code::FAILURE, error))?;
        tell(&context.health, &report);
        let newest_event = handle.with(|model| model.newest_event());
        let world = Self {
            handle,
            newest_event: watch::channel(newest_event).0,
            written,
        };
        Ok((thread, world))
    }

    /// Looks at the model, or changes it. The model is locked meanwhile: the work
    /// must be short.
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

    /// Changes whenever something has happened.
    pub(crate) fn events(&self) -> watch::Receiver<u64> {
        self.newest_event.subscribe()
    }

    /// The version of the model of which all is on disk.
    pub(crate) fn written(&self) -> watch::Receiver<u64> {
        self.written.clone()
    }
}

/// Says what was found, loudly when something is lost.
fn tell(health: &HealthBoard, report: &WorldReport) {
    if report.is_loss() {
        tracing::error!("{report}");
        health.set_state(ProcessState::Degraded, &report.to_string());
    } else {
        tracing::info!("{report}");
    }
}

/// Degraded while the disk does not follow; afterwards as it was before.
fn on_trouble(health: Arc<HealthBoard>) -> OnTrouble {
    let before = Mutex::new(None);
    Box::new(move |told| {
        let mut before = before.lock().unwrap_or_else(PoisonError::into_inner);
        match told {
            Err(error) => {
                let sentence = format!("the working memory is not on disk: {error}");
                tracing::error!("{sentence}");
                before.get_or_insert(health.state());
                health.set_state(ProcessState::Degraded, &sentence);
            }
            Ok(report) => {
                tracing::info!("the working memory is on disk again: {report}");
                if let Some((state, note)) = before.take() {
                    health.set_state(state, note.as_str().unwrap_or_default());
                }
            }
        }
    })
}
