//! Writer of the files of a recording: rotation by size and time, names, flushing.

use crate::counting_writer::CountingWriter;
use crate::foxglove_view::FoxgloveView;
use crate::queued_message::{self, Content, QueuedMessage};
use crate::segment_folder::{MEGABYTE, SegmentFolder, closed_path};
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
pub(crate) struct SegmentLimits {
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
pub(crate) struct SegmentWriter {
    folder: SegmentFolder,
    limits: SegmentLimits,
    foxglove: Option<FoxgloveView>,
    domain: String,
    file: Option<OpenFile>,
    /// Number of the newest file.
    number: u32,
    closed: Vec<PathBuf>,
    counts: RecordingCounts,
    encoded: Vec<u8>,
}

/// File that is written.
struct OpenFile {
    path: PathBuf,
    writer: RecordingWriter<CountingWriter>,
    n_bytes: Arc<AtomicU64>,
    opened: Instant,
    flushed: Instant,
}

fn not_written(path: &Path, error: impl std::fmt::Display) -> Failure {
    let sentence = format!(
        "{} could not be written: {error}; what was written before can be read",
        path.display()
    );
    Failure::general(sentence)
}

impl SegmentWriter {
    pub(crate) fn new(
        folder: SegmentFolder,
        limits: SegmentLimits,
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
            closed: Vec::new(),
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
        let written = self.write_to(&mut file, message);
        let written = written.map_err(|error| not_written(&file.path, error));
        self.file = Some(file);
        written?;
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
        let Some(file) = &mut self.file else {
            return Ok(());
        };
        if file.flushed.elapsed() < FLUSH_PERIOD {
            return Ok(());
        }
        file.flushed = Instant::now();
        let flushed = file.writer.flush();
        flushed.map_err(|error| not_written(&file.path, error))
    }

    /// Closes the file that is written, if any.
    ///
    /// # Errors
    /// When its end cannot be written.
    pub(crate) fn close(&mut self) -> Result<(), Failure> {
        let Some(mut file) = self.file.take() else {
            return Ok(());
        };
        let finished = file.writer.finish();
        finished.map_err(|error| not_written(&file.path, error))?;
        drop(file.writer);
        let closed = closed_path(&file.path);
        let synced = File::open(&file.path).and_then(|file| file.sync_all());
        let renamed = synced.and_then(|()| std::fs::rename(&file.path, &closed));
        renamed.map_err(|error| not_written(&file.path, error))?;
        self.counts.bytes += file.n_bytes.load(Ordering::Relaxed);
        self.closed.push(closed);
        Ok(())
    }

    /// Closes a file that has reached a limit, and deletes the oldest ones.
    fn rotate(&mut self) -> Result<(), Failure> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let n_bytes = file.n_bytes.load(Ordering::Relaxed);
        let is_large = n_bytes >= self.limits.rotate_mb.saturating_mul(MEGABYTE);
        if is_large || file.opened.elapsed().as_secs() >= self.limits.rotate_s {
            self.close()?;
        }
        Ok(())
    }

    fn open(&mut self) -> Result<OpenFile, Failure> {
        if let Some(keep_mb) = self.limits.keep_mb {
            // Room for a whole file, so that all together stay below the bound.
            let next_bytes = self.limits.rotate_mb.min(keep_mb).saturating_mul(MEGABYTE);
            self.counts.files_deleted += self.folder.delete_oldest(keep_mb, next_bytes);
        }
        self.number += 1;
        let path = self.folder.active_path(self.number);
        let file = File::options().write(true).create_new(true).open(&path);
        let file = file.map_err(|error| not_written(&path, error))?;
        let (out, n_bytes) = CountingWriter::new(file);
        let writer = self.begun(out).map_err(|error| not_written(&path, error))?;
        Ok(OpenFile {
            path,
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

    /// Closed files in their order.
    pub(crate) fn closed(&self) -> &[PathBuf] {
        &self.closed
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
