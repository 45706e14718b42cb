//! Shared state of background jobs: resources, progress, export buffer, history position.

use crate::upload::UploadLimits;
use control_protocol::JobOutcome;
use parking_lot::{Condvar, Mutex};
use perceptual_memory::{Position, StoreHandle};
use service::wall_clock_ns;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use tokio::sync::watch;

/// Resources shared by all jobs.
#[derive(Clone)]
pub(crate) struct JobContext {
    pub(crate) store: StoreHandle,
    pub(crate) scratch: PathBuf,
    pub(crate) uploads: Arc<Mutex<UploadLimits>>,
    pub(crate) descriptor_kind: &'static str,
    pub(crate) position: watch::Sender<Position>,
}

/// Progress and output of a job, shared with its thread.
#[derive(Default)]
pub(crate) struct Progress {
    pub(crate) done: AtomicU64,
    pub(crate) total: AtomicU64,
    pub(crate) is_abandoned: AtomicBool,
    pub(crate) outcome: Mutex<Option<JobOutcome>>,
    pub(crate) bytes: Mutex<ExportBuffer>,
    /// Number of export bytes that were read.
    pub(crate) n_read: AtomicU64,
    pub(crate) bytes_moved: Condvar,
}

impl Progress {
    /// `true` if the client has abandoned the job.
    pub(crate) fn is_abandoned(&self) -> bool {
        self.is_abandoned.load(Ordering::Relaxed)
    }

    /// Ends the job as soon as its thread notices.
    pub(crate) fn abandon(&self) {
        // Under the lock, so that a writer of the buffer either sees it or is already waiting.
        let buffer = self.bytes.lock();
        self.is_abandoned.store(true, Ordering::Relaxed);
        drop(buffer);
        self.bytes_moved.notify_all();
    }

    /// Sets the progress of the job.
    pub(crate) fn set(&self, done: u64, total: u64) {
        self.total.store(total, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
    }
}

/// Export bytes that are written and not yet read.
#[derive(Default)]
pub(crate) struct ExportBuffer {
    pub(crate) bytes: VecDeque<u8>,
    /// Offset in the export file of the first buffered byte.
    pub(crate) offset: u64,
}

/// Present time, nanoseconds since 1970, UTC.
pub(crate) fn wall_ns() -> u64 {
    wall_clock_ns().max(0) as u64
}

/// Publishes a new history position to all subscribers.
pub(crate) fn publish_position(to: &watch::Sender<Position>, position: Position) {
    to.send_if_modified(|known| {
        let is_news = *known != position;
        *known = position;
        is_news
    });
}
