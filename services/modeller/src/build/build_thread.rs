//! Thread that adds views to a model, at a low priority.

use crate::growth::{Growth, GrowthState, Step};
use crate::model_document::object_model;
use crate::object_receiver::ReceivedView;
use crossbeam::channel::{Receiver, SendTimeoutError, Sender, bounded, unbounded};
use object_model::ObjectModel;
use service::Failure;
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

/// Thread that owns the model while it grows.
#[derive(Debug)]
pub(super) struct BuildThread {
    views: Sender<ReceivedView>,
    progress: Receiver<BuildProgress>,
    handle: JoinHandle<Growth>,
}

impl BuildThread {
    /// Starts the thread at a nice value.
    pub(super) fn start(growth: Growth, niceness: u8) -> Result<Self, Failure> {
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

    /// Model after the view that is being added, with all views in agreement.
    pub(super) fn finish(self) -> Growth {
        drop(self.views);
        let joined = self.handle.join();
        joined.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

/// Adds views until there are no more, and brings them into agreement.
fn grow(
    mut growth: Growth,
    views: &Receiver<ReceivedView>,
    done: &Sender<BuildProgress>,
) -> Growth {
    let mut are_agreed = true;
    let mut n_wanted = N_FIRST_VIEWS;
    for view in views {
        let step = growth.add(&view);
        match step {
            Step::Fused => are_agreed = false,
            Step::Closed => are_agreed = true,
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
    if !are_agreed {
        growth.finish();
    }
    growth
}
