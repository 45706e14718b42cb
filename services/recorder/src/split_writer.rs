//! File splitting: a recording in files of bounded size and duration, one after the other.

use crate::counting_writer::CountingWriter;
use crate::file_closer::{Closed, FileCloser};
use crate::foxglove_view::FoxgloveView;
use crate::queued_message::{self, Content, QueuedMessage};
use crate::recording_folder::{MEGABYTE, NewFile, RecordingFolder};
use message::FrameHeader;
use recording::{MessageTime, RecordingWriter, encode_frame};
use service::Failure;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time after which written messages are handed to the operating system: what a killed recorder
/// loses at most.
const FLUSH_PERIOD: Duration = Duration::from_millis(500);

/// Limits of the files.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SplitLimits {
    pub(crate) rotate_mb: u64,
    pub(crate) rotate_s: u64,
    pub(crate) keep_mb: Option<u64>,
}

/// Counters of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct RecordingCounts {
    pub(crate) frames: u64,
    pub(crate) messages: u64,
    /// Number of frames with a header that is invalid.
    pub(crate) invalid_frames: u64,
    pub(crate) bytes: u64,
    pub(crate) files_deleted: u64,
}

/// Writer of a recording's files, one after the other.
pub(crate) struct SplitWriter {
    folder: RecordingFolder,
    limits: SplitLimits,
    foxglove: Option<FoxgloveView>,
    domain: String,
    file: Option<OpenFile>,
    /// Number of the newest file.
    number: u32,
    closer: FileCloser,
    /// Files that are no longer written.
    closed: Vec<PathBuf>,
    /// Reason why the bound of all recordings is not kept.
    excess: Option<String>,
    counts: RecordingCounts,
    encoded: Vec<u8>,
}

/// File that is written.
struct OpenFile {
    path: PathBuf,
    /// The file once more, which holds its lock.
    file: File,
    writer: RecordingWriter<CountingWriter>,
    n_bytes: Arc<AtomicU64>,
    opened: Instant,
    flushed: Instant,
}

fn not_written(path: &Path, error: impl std::fmt::Display) -> Failure {
    let sentence = format!(
        "{} could not be written: {error}; free disk space or record into another folder with \
         --out; what was written before can be read",
        path.display()
    );
    Failure::general(sentence)
}

impl SplitWriter {
    pub(crate) fn new(
        folder: RecordingFolder,
        limits: SplitLimits,
        foxglove: Option<FoxgloveView>,
        domain: &str,
    ) -> Self {
        Self {
            folder,
            limits,
            foxglove,
            domain: domain.to_owned(),
            file: None,
            number: 0,
            closer: FileCloser::default(),
            closed: Vec::new(),
            excess: None,
            counts: RecordingCounts::default(),
            encoded: Vec::new(),
        }
    }

    /// Writes a message, into a new file when the present one has reached a limit.
    ///
    /// # Errors
    /// When a file cannot be written; all messages before are in it.
    pub(crate) fn write(&mut self, message: &QueuedMessage) -> Result<(), Failure> {
        self.rotate()?;
        let mut file = match self.file.take() {
            Some(file) => file,
            None => self.open()?,
        };
        if let Err(error) = self.write_to(&mut file, message) {
            return Err(self.give_up(file, error));
        }
        self.file = Some(file);
        self.flush()
    }

    fn write_to(
        &mut self,
        file: &mut OpenFile,
        message: &QueuedMessage,
    ) -> Result<(), recording::Error> {
        let time = MessageTime::at(message.received_ns);
        match &message.content {
            Content::Frame(frame) => {
                let (header, points) = (frame.header(), frame.items());
                if encode_frame(header, points, &mut self.encoded).is_err() {
                    self.counts.invalid_frames += 1;
                    return Ok(());
                }
                let time = frame_time(header, time);
                file.writer.write_frame(time, &self.encoded)?;
                self.counts.frames += 1;
            }
            other => queued_message::write_document(&mut file.writer, time, other)?,
        }
        self.counts.messages += 1;
        match &mut self.foxglove {
            Some(foxglove) => foxglove.write(&mut file.writer, message),
            None => Ok(()),
        }
    }

    /// Hands what was written to the operating system if that is due.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub(crate) fn flush(&mut self) -> Result<(), Failure> {
        let Some(mut file) = self.file.take() else {
            return Ok(());
        };
        if file.flushed.elapsed() >= FLUSH_PERIOD {
            file.flushed = Instant::now();
            if let Err(error) = file.writer.flush() {
                return Err(self.give_up(file, error));
            }
        }
        self.file = Some(file);
        Ok(())
    }

    /// Leaves a file that cannot be written as it is.
    fn give_up(&mut self, file: OpenFile, error: recording::Error) -> Failure {
        let failure = not_written(&file.path, error);
        self.counts.bytes += file.n_bytes.load(Ordering::Relaxed);
        self.closed.push(file.path);
        failure
    }

    /// Closes the file that is written, if any, and waits until all are on disk.
    ///
    /// # Errors
    /// When the end of a file cannot be written.
    pub(crate) fn close(&mut self) -> Result<(), Failure> {
        let ended = self.end_file();
        let closed = self.closer.wait();
        self.note_closed(closed).and(ended)
    }

    /// Ends the file that is written, if any; the disk gets it meanwhile.
    fn end_file(&mut self) -> Result<(), Failure> {
        let Some(mut file) = self.file.take() else {
            return Ok(());
        };
        if let Err(error) = file.writer.finish() {
            return Err(self.give_up(file, error));
        }
        drop(file.writer);
        self.counts.bytes += file.n_bytes.load(Ordering::Relaxed);
        let [before, failed] = self.closer.close(file.path, file.file);
        self.note_closed(before).and(self.note_closed(failed))
    }

    fn note_closed(&mut self, closed: Option<Closed>) -> Result<(), Failure> {
        match closed {
            None => Ok(()),
            Some((_, Ok(path))) => {
                self.closed.push(path);
                Ok(())
            }
            Some((path, Err(error))) => {
                let failure = not_written(&path, error);
                self.closed.push(path);
                Err(failure)
            }
        }
    }

    /// Closes a file that has reached a limit, and deletes the oldest ones.
    fn rotate(&mut self) -> Result<(), Failure> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let n_bytes = file.n_bytes.load(Ordering::Relaxed);
        let is_large = n_bytes >= self.limits.rotate_mb.saturating_mul(MEGABYTE);
        if is_large || file.opened.elapsed().as_secs() >= self.limits.rotate_s {
            self.end_file()?;
        }
        Ok(())
    }

    /// Deletes the oldest recordings, so that all together stay below their bound.
    fn make_room(&mut self) {
        let Some(keep_mb) = self.limits.keep_mb else {
            return;
        };
        // Room for a whole file.
        let next_bytes = self.limits.rotate_mb.min(keep_mb).saturating_mul(MEGABYTE);
        let deletion = self.folder.delete_oldest(keep_mb, next_bytes);
        self.counts.files_deleted += deletion.n_files;
        self.closed.retain(|path| path.exists());
        if let (Some((path, error)), None) = (deletion.refusal, &self.excess) {
            self.excess = Some(format!(
                "{} could not be deleted: {error}; the recordings have more than --keep-mb \
                 {keep_mb} as long as it is there",
                path.display()
            ));
        }
    }

    fn open(&mut self) -> Result<OpenFile, Failure> {
        self.make_room();
        let created = self.folder.create_file(self.number);
        let created = created.map_err(|error| not_written(self.folder.path(), error))?;
        let NewFile { number, path, file } = created;
        self.number = number;
        let second = file.try_clone();
        let second = second.map_err(|error| not_written(&path, error))?;
        let (out, n_bytes) = CountingWriter::new(file);
        let writer = self.begun(out).map_err(|error| not_written(&path, error))?;
        Ok(OpenFile {
            path,
            file: second,
            writer,
            n_bytes,
            opened: Instant::now(),
            flushed: Instant::now(),
        })
    }

    /// Begins a file with the definitions of all channels.
    fn begun(
        &self,
        out: CountingWriter,
    ) -> Result<RecordingWriter<CountingWriter>, recording::Error> {
        let mut writer = RecordingWriter::new(out, &self.domain)?;
        let mut channels = queued_message::channels();
        if self.foxglove.is_some() {
            channels.extend(FoxgloveView::channels());
        }
        for channel in &channels {
            writer.add_channel(channel)?;
        }
        writer.flush()?;
        Ok(writer)
    }

    /// Counters so far, with the file that is written.
    pub(crate) fn counts(&self) -> RecordingCounts {
        let open = self.file.as_ref();
        let bytes = open.map_or(0, |file| file.n_bytes.load(Ordering::Relaxed));
        RecordingCounts {
            bytes: self.counts.bytes + bytes,
            ..self.counts
        }
    }

    /// Files that are no longer written, in their order, as far as they were not deleted.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        let files = self.closed.iter().filter(|path| path.exists());
        files.cloned().collect()
    }

    /// Free space of the disk, megabytes; `None` when it is not known.
    pub(crate) fn free_mb(&self) -> Option<u64> {
        self.folder.free_mb()
    }

    /// Takes the reason, once, why the bound of all recordings is not kept.
    pub(crate) fn take_excess(&mut self) -> Option<String> {
        self.excess.take()
    }
}

/// Times of a frame: its publication on the wall clock, when that is known.
fn frame_time(header: &FrameHeader, received: MessageTime) -> MessageTime {
    let offset_ns = header.wall_clock_offset_ns;
    let published_ns = header.published_stamp_ns.checked_add_signed(offset_ns);
    MessageTime {
        publish_ns: published_ns.unwrap_or(received.log_ns),
        ..received
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use message::MemoryChange;

    #[test]
    fn files_that_were_deleted_are_not_named() {
        let folder = tempfile::tempdir().unwrap();
        let recordings = RecordingFolder::create(folder.path(), "left", 7).unwrap();
        // A file for each message, and no room for another.
        let limits = SplitLimits {
            rotate_mb: 1,
            rotate_s: 0,
            keep_mb: Some(1),
        };
        let mut writer = SplitWriter::new(recordings, limits, None, "left");
        for received_ns in 0..4 {
            let content = Content::Memory(MemoryChange::default());
            let message = QueuedMessage {
                received_ns,
                content,
            };
            writer.write(&message).unwrap();
        }
        writer.close().unwrap();
        let files = writer.files();
        assert!(files.iter().all(|path| path.exists()), "{files:?}");
        let n_deleted = writer.counts().files_deleted;
        assert!(n_deleted >= 2, "{n_deleted}");
        assert_eq!(files.len() as u64, 4 - n_deleted);
    }
}
