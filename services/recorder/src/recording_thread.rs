//! Writer thread: takes messages from the queue and writes them to files.

use crate::message_queue::{MessageQueue, Taken};
use crate::segment_writer::{RecordingCounts, SegmentWriter};
use parking_lot::Mutex;
use service::Failure;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

/// Longest time without a look at what is due. Chosen.
const PATIENCE: Duration = Duration::from_millis(100);

/// Running writer thread.
pub(crate) struct RecordingThread {
    queue: Arc<MessageQueue>,
    counts: Arc<Mutex<RecordingCounts>>,
    thread: JoinHandle<Result<Written, Failure>>,
}

/// Result of a finished writer.
#[derive(Debug)]
pub(crate) struct Written {
    pub(crate) counts: RecordingCounts,
    pub(crate) files: Vec<PathBuf>,
}

impl RecordingThread {
    /// Starts the thread.
    ///
    /// # Errors
    /// When it cannot be started.
    pub(crate) fn start(
        mut writer: SegmentWriter,
        queue: Arc<MessageQueue>,
    ) -> Result<Self, Failure> {
        let counts = Arc::new(Mutex::new(RecordingCounts::default()));
        let (source, shown) = (queue.clone(), counts.clone());
        let thread = std::thread::Builder::new()
            .name("recording".into())
            .spawn(move || write_all(&mut writer, &source, &shown))
            .map_err(|error| {
                Failure::general(format!("could not start the writer thread: {error}"))
            })?;
        Ok(Self {
            queue,
            counts,
            thread,
        })
    }

    /// Counters so far.
    pub(crate) fn counts(&self) -> RecordingCounts {
        *self.counts.lock()
    }

    /// True if the thread has ended by itself, after a failure.
    pub(crate) fn has_ended(&self) -> bool {
        self.thread.is_finished()
    }

    /// Writes what is queued, closes the file and ends the thread.
    ///
    /// # Errors
    /// When a file could not be written.
    pub(crate) fn finish(self) -> Result<Written, Failure> {
        self.queue.close();
        let panicked = |_| Failure::general("the writer thread has panicked");
        self.thread.join().map_err(panicked)?
    }
}

fn write_all(
    writer: &mut SegmentWriter,
    queue: &MessageQueue,
    shown: &Mutex<RecordingCounts>,
) -> Result<Written, Failure> {
    loop {
        match queue.take(PATIENCE) {
            Taken::Message(message) => writer.write(&message)?,
            Taken::Nothing => writer.flush()?,
            Taken::End => break,
        }
        *shown.lock() = writer.counts();
    }
    writer.close()?;
    Ok(Written {
        counts: writer.counts(),
        files: writer.closed().to_vec(),
    })
}
