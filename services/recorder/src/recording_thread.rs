//! Writer thread: takes messages from the queue and writes them to files.

use crate::message_queue::{MessageQueue, Taken};
use crate::split_writer::{RecordingCounts, SplitWriter};
use crate::status_lines::StatusLines;
use parking_lot::Mutex;
use service::Failure;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Longest time without a look at what is due. Chosen.
const PATIENCE: Duration = Duration::from_millis(100);
/// Period of the checks of the disk, which may block as its writing may.
const DISK_PERIOD: Duration = Duration::from_secs(1);

/// Limits at which the writer ends the recording.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EndLimits {
    /// Number of frames.
    pub(crate) frames: Option<u64>,
    /// Free space of the disk, megabytes.
    pub(crate) min_free_mb: u64,
}

/// Reason for the end of a writer.
#[derive(Debug)]
pub(crate) enum WriterEnd {
    /// All messages of the queue, which was closed, are written.
    Drained,
    /// All frames that were asked for are written.
    AllFrames,
    /// The disk has only this free space, megabytes.
    DiskFull(u64),
    /// A file could not be written.
    Failed(Failure),
}

/// Running writer thread.
pub(crate) struct RecordingThread {
    queue: Arc<MessageQueue>,
    counts: Arc<Mutex<RecordingCounts>>,
    thread: JoinHandle<Written>,
}

/// Result of a finished writer.
#[derive(Debug)]
pub(crate) struct Written {
    pub(crate) counts: RecordingCounts,
    pub(crate) files: Vec<PathBuf>,
    pub(crate) end: WriterEnd,
}

impl RecordingThread {
    /// Starts the thread.
    ///
    /// # Errors
    /// When it cannot be started.
    pub(crate) fn start(
        writer: SplitWriter,
        queue: Arc<MessageQueue>,
        limits: EndLimits,
        status: StatusLines,
    ) -> Result<Self, Failure> {
        let counts = Arc::new(Mutex::new(RecordingCounts::default()));
        let task = WriterTask {
            writer,
            queue: queue.clone(),
            limits,
            shown: counts.clone(),
            status,
        };
        let thread = std::thread::Builder::new()
            .name("recording".into())
            .spawn(move || task.run())
            .map_err(|error| {
                Failure::general(format!(
                    "could not start the writer thread: {error}; raise the limit of threads"
                ))
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

    /// True if the thread has ended by itself, at a limit or after a failure.
    pub(crate) fn has_ended(&self) -> bool {
        self.thread.is_finished()
    }

    /// Writes what is queued, closes the file and ends the thread.
    pub(crate) fn finish(self) -> Written {
        self.queue.close();
        let counts = self.counts;
        self.thread.join().unwrap_or_else(|_| Written {
            counts: *counts.lock(),
            files: Vec::new(),
            end: WriterEnd::Failed(Failure::general(
                "the writer thread has panicked; `tabula record --recover` makes whole files of \
                 what it wrote",
            )),
        })
    }
}

/// Task of the writer thread.
struct WriterTask {
    writer: SplitWriter,
    queue: Arc<MessageQueue>,
    limits: EndLimits,
    shown: Arc<Mutex<RecordingCounts>>,
    status: StatusLines,
}

impl WriterTask {
    fn run(mut self) -> Written {
        let mut end = self.write_all().unwrap_or_else(WriterEnd::Failed);
        if let Err(failure) = self.writer.close()
            && !matches!(end, WriterEnd::Failed(_))
        {
            end = WriterEnd::Failed(failure);
        }
        Written {
            counts: self.writer.counts(),
            files: self.writer.files(),
            end,
        }
    }

    fn write_all(&mut self) -> Result<WriterEnd, Failure> {
        let mut next_look = Instant::now();
        loop {
            match self.queue.take(PATIENCE) {
                Taken::Message(message) => self.writer.write(&message)?,
                Taken::Nothing => self.writer.flush()?,
                Taken::End => return Ok(WriterEnd::Drained),
            }
            let counts = self.writer.counts();
            *self.shown.lock() = counts;
            if self.limits.frames.is_some_and(|n| counts.frames >= n) {
                return Ok(WriterEnd::AllFrames);
            }
            if let Some(excess) = self.writer.take_excess() {
                self.status.print(excess);
            }
            if Instant::now() >= next_look {
                next_look = Instant::now() + DISK_PERIOD;
                let free_mb = self.writer.free_mb();
                if let Some(mb) = free_mb.filter(|mb| *mb < self.limits.min_free_mb) {
                    return Ok(WriterEnd::DiskFull(mb));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queued_message::{Content, QueuedMessage};
    use crate::recording_folder::RecordingFolder;
    use crate::split_writer::SplitLimits;
    use command_line::Output;
    use message::MemoryChange;
    use std::path::Path;

    /// Result of a writer that was given messages until it ended, or none.
    fn written(folder: &Path, min_free_mb: u64, is_there: bool) -> Written {
        let recordings = RecordingFolder::create(folder, "left", 7).unwrap();
        if !is_there {
            std::fs::remove_dir(folder).unwrap();
        }
        let limits = SplitLimits {
            rotate_mb: 1,
            rotate_s: 100,
            keep_mb: None,
        };
        let writer = SplitWriter::new(recordings, limits, None, "left");
        let queue = Arc::new(MessageQueue::default());
        queue.push(QueuedMessage {
            received_ns: 1,
            content: Content::Memory(MemoryChange::default()),
        });
        let ends = EndLimits {
            frames: None,
            min_free_mb,
        };
        let status = StatusLines::start(Output::new(true)).unwrap();
        let thread = RecordingThread::start(writer, queue, ends, status).unwrap();
        thread.finish()
    }

    #[test]
    fn writer_ends_at_the_limit_of_free_space_with_a_whole_file() {
        let folder = tempfile::tempdir().unwrap();
        let written = written(folder.path(), u64::MAX, true);
        assert!(matches!(written.end, WriterEnd::DiskFull(_)), "{written:?}");
        assert_eq!(written.counts.messages, 1);
        assert!(written.files[0].ends_with("left-7-0001.mcap"));
    }

    #[test]
    fn writer_that_fails_gives_its_counts_and_a_next_step() {
        let parent = tempfile::tempdir().unwrap();
        let written = written(&parent.path().join("away"), 0, false);
        let WriterEnd::Failed(failure) = &written.end else {
            panic!("{written:?}");
        };
        assert!(failure.sentence.contains("--out"), "{failure}");
        assert_eq!(written.counts, RecordingCounts::default());
    }
}
