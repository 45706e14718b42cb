//! Thread that adds views to a model, at a low priority.

use super::POLL_PERIOD;
use crate::growth::{Growth, GrowthState, Step};
use crate::model_document::object_model;
use crate::object_receiver::ReceivedView;
use crossbeam::channel::{Receiver, SendTimeoutError, Sender, bounded, unbounded};
use model_construction::{Config, PoseSigma};
use object_model::ObjectModel;
use service::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// Number of views after which the model so far is given out for the first time. Chosen.
const N_FIRST_VIEWS: usize = 4;

/// Result of a view, and the state of the model after it.
#[derive(Debug)]
pub(super) struct BuildProgress {
    pub(super) step: Step,
    pub(super) state: GrowthState,
    /// Model so far, each time that its views have doubled.
    pub(super) unfinished: Option<ObjectModel>,
}

/// Grown model.
#[derive(Debug)]
pub(super) struct Grown {
    pub(super) growth: Growth,
    /// `false` where bringing the views into agreement was stopped.
    pub(super) is_agreed: bool,
}

/// Thread that owns the model while it grows.
#[derive(Debug)]
pub(super) struct BuildThread {
    views: Sender<ReceivedView>,
    progress: Receiver<BuildProgress>,
    stop: Arc<AtomicBool>,
    handle: JoinHandle<Grown>,
}

impl BuildThread {
    /// Starts the thread at a nice value, with an empty model.
    pub(super) fn start(config: Config, sigma: PoseSigma, niceness: u8) -> Result<Self, Failure> {
        let stop = Arc::new(AtomicBool::new(false));
        let growth = Growth::new(config, sigma, stop.clone());
        // Without a buffer: views wait in the queue, where those that tell nothing are left out.
        let (views, to_add) = bounded(0);
        let (done, progress) = unbounded();
        let handle = std::thread::Builder::new()
            .name("model".to_owned())
            .spawn(move || {
                // Refused to no process that asks for less; else the model grows at the priority
                // of the process.
                let _ = rustix::process::setpriority_process(None, niceness.into());
                grow(growth, &to_add, &done)
            })
            .map_err(|error| {
                Failure::general(format!("the thread of the model did not start: {error}"))
            })?;
        Ok(Self {
            views,
            progress,
            stop,
            handle,
        })
    }

    /// Gives a view to the thread; returns it if the thread is not ready within the time.
    pub(super) fn add(&self, view: ReceivedView, patience: Duration) -> Option<ReceivedView> {
        let sent = self.views.send_timeout(view, patience);
        sent.err().map(SendTimeoutError::into_inner)
    }

    /// Next result, if there is one.
    pub(super) fn progress(&self) -> Option<BuildProgress> {
        self.progress.try_recv().ok()
    }

    /// `true` after a panic, which `finish` passes on.
    pub(super) fn has_ended(&self) -> bool {
        self.handle.is_finished()
    }

    /// Model after the view that is being added, with all views in agreement, unless that is
    /// stopped.
    pub(super) fn finish(self, is_stopped: impl Fn() -> bool) -> Grown {
        // Before the thread begins with it, where it is stopped already.
        self.stop.store(is_stopped(), Ordering::Relaxed);
        drop(self.views);
        while !self.handle.is_finished() {
            if is_stopped() {
                self.stop.store(true, Ordering::Relaxed);
            }
            std::thread::sleep(POLL_PERIOD);
        }
        let joined = self.handle.join();
        joined.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

/// Adds views until there are no more, and brings them into agreement.
fn grow(mut growth: Growth, views: &Receiver<ReceivedView>, done: &Sender<BuildProgress>) -> Grown {
    let mut is_agreed = true;
    let mut n_wanted = N_FIRST_VIEWS;
    for view in views {
        let step = growth.add(&view);
        match step {
            Step::Fused => is_agreed = false,
            Step::Closed => is_agreed = true,
            Step::Nothing | Step::Refused => {}
        }
        let state = growth.state();
        let n_views = growth.builder().views().len();
        let unfinished = (n_views >= n_wanted).then(|| object_model(&growth));
        if unfinished.is_some() {
            n_wanted = 2 * n_views;
        }
        // Nobody listens any more when the construction was left by an error.
        let _ = done.send(BuildProgress {
            step,
            state,
            unfinished,
        });
    }
    let is_agreed = is_agreed || growth.finish();
    Grown { growth, is_agreed }
}
