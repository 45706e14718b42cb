//! `tabula record`: records the running daemon until it ends, a limit is reached, or a stop.

use crate::arguments::RecordArguments;
use crate::foxglove_view::FoxgloveView;
use crate::message_queue::MessageQueue;
use crate::recording_thread::{RecordingThread, Written};
use crate::segment_folder::{MEGABYTE, SegmentFolder};
use crate::segment_writer::{RecordingCounts, SegmentLimits, SegmentWriter};
use crate::topic_receiver::TopicReceiver;
use channel::{Domain, DomainName, DomainState, Role, RunFolder};
use command_line::{Output, StopSignal};
use serde::Serialize;
use service::{CommonArguments, Failure, wall_clock_ns};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Polling period of the topics: shorter than two frames of any source.
const POLL_PERIOD: Duration = Duration::from_millis(2);
/// Period of the checks of daemon and disk.
const CHECK_PERIOD: Duration = Duration::from_secs(1);
/// Period of the lines that show the progress.
const PROGRESS_PERIOD: Duration = Duration::from_secs(5);

/// Recording as a JSON document.
#[derive(Debug, Serialize)]
struct RecordedDocument {
    files: Vec<String>,
    seconds: f64,
    frames: u64,
    messages: u64,
    bytes: u64,
    /// Frames that were not recorded: displaced by newer ones.
    frames_dropped: u64,
    /// Other messages that were not recorded.
    messages_dropped: u64,
    frames_invalid: u64,
    files_deleted: u64,
    end: &'static str,
}

/// Reason for the end of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RecordingEnd {
    Stopped,
    DaemonEnded,
    Limit,
    DiskFull,
    WriterFailed,
}

impl RecordingEnd {
    fn word(self) -> &'static str {
        match self {
            Self::Stopped => "stopped",
            Self::DaemonEnded => "the daemon has ended",
            Self::Limit => "the limit is reached",
            Self::DiskFull => "the disk has too little free space",
            Self::WriterFailed => "the writer has failed",
        }
    }
}

/// Records the daemon of the domain.
pub(crate) fn run(
    common: &CommonArguments,
    arguments: &RecordArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    arguments.check()?;
    let stop = StopSignal::install()?;
    let mut recorder = RunningRecording::start(&common.domain, arguments, output)?;
    let end = recorder.record(arguments, &stop)?;
    let free_mb = recorder.folder.free_mb();
    let document = recorder.finish(end)?;
    output.answer(&document, || text(&document));
    if end == RecordingEnd::DiskFull {
        return Err(Failure::general(format!(
            "the recording has stopped: {} MB are free on the disk, and --min-free-mb {} are to \
             stay free",
            free_mb.unwrap_or(0),
            arguments.min_free_mb
        )));
    }
    Ok(ExitCode::SUCCESS)
}

/// Running recording.
struct RunningRecording<'a> {
    receiver: TopicReceiver,
    queue: Arc<MessageQueue>,
    thread: RecordingThread,
    folder: SegmentFolder,
    domain: DomainName,
    started: Instant,
    output: &'a Output,
}

impl<'a> RunningRecording<'a> {
    fn start(
        name: &DomainName,
        arguments: &RecordArguments,
        output: &'a Output,
    ) -> Result<Self, Failure> {
        if !is_running(name) {
            return Err(Failure::general(format!(
                "no daemon runs in the domain {name}; start one with `tabula run`"
            )));
        }
        let domain = Domain::join(name, &RunFolder::of_user(), Role::Guest)?;
        let here = Path::new(".");
        let path = arguments.out.as_deref().unwrap_or(here);
        let start_s = wall_clock_ns().unsigned_abs() / 1_000_000_000;
        let folder = SegmentFolder::create(path, &name.to_string(), start_s)?;
        let queue = Arc::new(MessageQueue::default());
        let foxglove = FoxgloveView::new(arguments.foxglove_hz, arguments.foxglove_points);
        let limits = limits(arguments);
        let writer = SegmentWriter::new(folder.clone(), limits, foxglove, &name.to_string());
        let receiver = TopicReceiver::new(&domain)?;
        let thread = RecordingThread::start(writer, queue.clone())?;
        output.print_status(&format!(
            "recording the daemon of the domain {name} into {}; Ctrl-C ends it",
            path.display()
        ));
        Ok(Self {
            receiver,
            queue,
            thread,
            folder,
            domain: name.clone(),
            started: Instant::now(),
            output,
        })
    }

    /// Moves messages from the topics to the writer until an end.
    fn record(
        &mut self,
        arguments: &RecordArguments,
        stop: &StopSignal,
    ) -> Result<RecordingEnd, Failure> {
        let mut next_check = self.started + CHECK_PERIOD;
        let mut next_line = self.started + PROGRESS_PERIOD;
        loop {
            self.receiver.receive(&self.queue)?;
            if stop.is_raised() {
                return Ok(RecordingEnd::Stopped);
            }
            if self.thread.has_ended() {
                return Ok(RecordingEnd::WriterFailed);
            }
            let counts = self.thread.counts();
            if is_at_limit(arguments, &counts, self.started.elapsed()) {
                return Ok(RecordingEnd::Limit);
            }
            if Instant::now() >= next_check {
                next_check = Instant::now() + CHECK_PERIOD;
                if !is_running(&self.domain) {
                    return Ok(RecordingEnd::DaemonEnded);
                }
                if self
                    .folder
                    .free_mb()
                    .is_some_and(|mb| mb < arguments.min_free_mb)
                {
                    return Ok(RecordingEnd::DiskFull);
                }
            }
            if Instant::now() >= next_line {
                next_line = Instant::now() + PROGRESS_PERIOD;
                self.print_progress(&counts);
            }
            stop.sleep(POLL_PERIOD);
        }
    }

    fn print_progress(&self, counts: &RecordingCounts) {
        let (frames, _) = self.n_dropped();
        self.output.print_status(&format!(
            "{:.0} s: {} frames, {:.1} MB, {frames} frames dropped",
            self.started.elapsed().as_secs_f64(),
            counts.frames,
            counts.bytes as f64 / MEGABYTE as f64,
        ));
    }

    /// Numbers of frames and of other messages that were not recorded.
    fn n_dropped(&self) -> (u64, u64) {
        let dropped = self.queue.dropped();
        (
            dropped.frames + self.receiver.n_frames_lost(),
            dropped.others + self.receiver.n_others_lost(),
        )
    }

    fn finish(self, end: RecordingEnd) -> Result<RecordedDocument, Failure> {
        let seconds = self.started.elapsed().as_secs_f64();
        let (frames_dropped, messages_dropped) = self.n_dropped();
        let Written { counts, files } = self.thread.finish()?;
        Ok(RecordedDocument {
            files: files
                .iter()
                .map(|path| path.display().to_string())
                .collect(),
            seconds,
            frames: counts.frames,
            messages: counts.messages,
            bytes: counts.bytes,
            frames_dropped,
            messages_dropped,
            frames_invalid: counts.invalid_frames,
            files_deleted: counts.files_deleted,
            end: end.word(),
        })
    }
}

/// Limits of the files. Half of the total is for the file that is written, so that the closed
/// ones can be deleted one by one.
fn limits(arguments: &RecordArguments) -> SegmentLimits {
    let half_mb = arguments
        .keep_mb
        .map_or(u64::MAX, |keep_mb| (keep_mb / 2).max(1));
    SegmentLimits {
        rotate_mb: arguments.rotate_mb.min(half_mb),
        rotate_s: arguments.rotate_s,
        keep_mb: arguments.keep_mb,
    }
}

fn is_at_limit(arguments: &RecordArguments, counts: &RecordingCounts, elapsed: Duration) -> bool {
    let has_frames = |n| counts.frames >= n;
    let is_over = |s| elapsed.as_secs() >= s;
    arguments.frames.is_some_and(has_frames) || arguments.duration_s.is_some_and(is_over)
}

/// True if a process of a daemon runs in the domain.
fn is_running(domain: &DomainName) -> bool {
    let state = DomainState::inspect(domain, &RunFolder::of_user());
    !state.running.is_empty()
}

fn text(document: &RecordedDocument) -> String {
    let RecordedDocument {
        files,
        seconds,
        frames,
        messages,
        bytes,
        frames_dropped,
        messages_dropped,
        frames_invalid,
        files_deleted,
        end,
    } = document;
    let mut lines = vec![format!(
        "{end}: {frames} frames and {} other messages of {seconds:.1} s in {} file(s), {:.1} MB",
        messages - frames,
        files.len(),
        *bytes as f64 / MEGABYTE as f64,
    )];
    for (n, what) in [
        (frames_dropped, "frames were dropped"),
        (messages_dropped, "other messages were dropped"),
        (frames_invalid, "frames were invalid"),
        (files_deleted, "old files were deleted"),
    ] {
        if *n > 0 {
            lines.push(format!("{n} {what}"));
        }
    }
    lines.extend(files.iter().cloned());
    lines.join("\n")
}
