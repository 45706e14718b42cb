//! `tabula record`: records the running daemon until it ends, a limit is reached, or a stop.

use crate::arguments::RecordArguments;
use crate::foxglove_view::FoxgloveView;
use crate::message_queue::MessageQueue;
use crate::recording_folder::{MEGABYTE, RecordingFolder};
use crate::recording_thread::{EndLimits, RecordingThread, WriterEnd, Written};
use crate::split_writer::{SplitLimits, SplitWriter};
use crate::status_lines::StatusLines;
use crate::topic_receiver::TopicReceiver;
use channel::{Domain, DomainName, DomainState, Role, RunFolder};
use command_line::{Output, StopSignal};
use serde::Serialize;
use service::{CommonArguments, Failure, exit_code, wall_clock_ns};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Polling period of the topics: shorter than two frames of any source.
const POLL_PERIOD: Duration = Duration::from_millis(2);
/// Period of the checks of the daemon.
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
    /// Sentence about a failure that has ended the recording.
    error: Option<String>,
}

/// Reason for the end of a recording.
#[derive(Debug)]
enum RecordingEnd {
    Stopped,
    DaemonEnded,
    Limit,
    DiskFull(Failure),
    WriterFailed(Failure),
    ReceiverFailed(Failure),
    /// The writer has ended by itself and knows the reason.
    WriterEnded,
}

impl RecordingEnd {
    /// Reason with the writer's, which goes first.
    fn with(self, writer: WriterEnd, min_free_mb: u64) -> Self {
        match (writer, self) {
            (WriterEnd::Failed(failure), _) => Self::WriterFailed(failure),
            (WriterEnd::DiskFull(free_mb), _) => Self::DiskFull(Failure::general(format!(
                "the recording has stopped: {free_mb} MB are free on the disk, and --min-free-mb \
                 {min_free_mb} are to stay free; free disk space, or record into another folder"
            ))),
            (WriterEnd::AllFrames, _) | (WriterEnd::Drained, Self::WriterEnded) => Self::Limit,
            (WriterEnd::Drained, end) => end,
        }
    }

    fn word(&self) -> &'static str {
        match self {
            Self::Stopped => "stopped",
            Self::DaemonEnded => "the daemon has ended",
            Self::Limit | Self::WriterEnded => "the limit is reached",
            Self::DiskFull(_) => "the disk has too little free space",
            Self::WriterFailed(_) => "a file could not be written",
            Self::ReceiverFailed(_) => "the topics could not be received",
        }
    }

    fn failure(&self) -> Option<&Failure> {
        match self {
            Self::Stopped | Self::DaemonEnded | Self::Limit | Self::WriterEnded => None,
            Self::DiskFull(failure)
            | Self::WriterFailed(failure)
            | Self::ReceiverFailed(failure) => Some(failure),
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
    let end = recorder.record(arguments, &stop);
    let (document, end) = recorder.finish(end, arguments.min_free_mb);
    output.answer(&document, || text(&document));
    match end.failure() {
        None => Ok(ExitCode::SUCCESS),
        // The failure is in the one document.
        Some(failure) if output.is_json() => {
            output.print_status(&failure.sentence);
            Ok(ExitCode::from(failure.code))
        }
        Some(failure) => Err(failure.clone()),
    }
}

/// Running recording.
struct RunningRecording {
    receiver: TopicReceiver,
    queue: Arc<MessageQueue>,
    thread: RecordingThread,
    domain: DomainName,
    started: Instant,
    status: StatusLines,
}

impl RunningRecording {
    fn start(
        name: &DomainName,
        arguments: &RecordArguments,
        output: &Output,
    ) -> Result<Self, Failure> {
        if !is_running(name) {
            return Err(Failure::new(
                exit_code::NO_DAEMON,
                format!("no daemon runs in the domain {name}; start one with `tabula run`"),
            ));
        }
        let domain = Domain::join(name, &RunFolder::of_user(), Role::Guest)?;
        let path = arguments.out.as_deref().unwrap_or(Path::new("."));
        let start_s = wall_clock_ns().unsigned_abs() / 1_000_000_000;
        let folder = RecordingFolder::create(path, &name.to_string(), start_s)?;
        let queue = Arc::new(MessageQueue::default());
        let foxglove = FoxgloveView::new(arguments.foxglove_hz, arguments.foxglove_points);
        let writer = SplitWriter::new(folder, limits(arguments), foxglove, &name.to_string());
        let receiver = TopicReceiver::new(&domain)?;
        let status = StatusLines::start(output.clone())?;
        let ends = EndLimits {
            frames: arguments.frames,
            min_free_mb: arguments.min_free_mb,
        };
        let thread = RecordingThread::start(writer, queue.clone(), ends, status.clone())?;
        status.print(format!(
            "recording the daemon of the domain {name} into {}; Ctrl-C ends it",
            path.display()
        ));
        Ok(Self {
            receiver,
            queue,
            thread,
            domain: name.clone(),
            started: Instant::now(),
            status,
        })
    }

    /// Moves messages from the topics to the writer until an end. Nothing here waits for a disk
    /// or a terminal.
    fn record(&mut self, arguments: &RecordArguments, stop: &StopSignal) -> RecordingEnd {
        let mut next_check = self.started + CHECK_PERIOD;
        let mut next_line = self.started + PROGRESS_PERIOD;
        let is_over =
            |elapsed: Duration| arguments.duration_s.is_some_and(|s| elapsed.as_secs() >= s);
        loop {
            if let Err(error) = self.receiver.receive(&self.queue) {
                return RecordingEnd::ReceiverFailed(error.into());
            }
            if stop.is_raised() {
                return RecordingEnd::Stopped;
            }
            if self.thread.has_ended() {
                return RecordingEnd::WriterEnded;
            }
            if is_over(self.started.elapsed()) {
                return RecordingEnd::Limit;
            }
            if Instant::now() >= next_check {
                next_check = Instant::now() + CHECK_PERIOD;
                if !is_running(&self.domain) {
                    return RecordingEnd::DaemonEnded;
                }
            }
            if Instant::now() >= next_line {
                next_line = Instant::now() + PROGRESS_PERIOD;
                self.print_progress();
            }
            stop.sleep(POLL_PERIOD);
        }
    }

    fn print_progress(&self) {
        let counts = self.thread.counts();
        let (frames, _) = self.n_dropped();
        self.status.print(format!(
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

    /// Writes what is queued and closes the files, whatever has ended the recording.
    fn finish(self, end: RecordingEnd, min_free_mb: u64) -> (RecordedDocument, RecordingEnd) {
        let seconds = self.started.elapsed().as_secs_f64();
        let (frames_dropped, messages_dropped) = self.n_dropped();
        let Written {
            counts,
            files,
            end: writer_end,
        } = self.thread.finish();
        let end = end.with(writer_end, min_free_mb);
        let document = RecordedDocument {
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
            error: end.failure().map(|failure| failure.sentence.clone()),
        };
        (document, end)
    }
}

/// Limits of the files. Half of the total is for the file that is written, so that the closed
/// ones can be deleted one by one.
fn limits(arguments: &RecordArguments) -> SplitLimits {
    let half_mb = arguments
        .keep_mb
        .map_or(u64::MAX, |keep_mb| (keep_mb / 2).max(1));
    SplitLimits {
        rotate_mb: arguments.rotate_mb.min(half_mb),
        rotate_s: arguments.rotate_s,
        keep_mb: arguments.keep_mb,
    }
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
        error: _,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_of_a_recording_is_the_first_failure() {
        let failed = || Failure::general("it failed");
        let end = |end: RecordingEnd, writer| end.with(writer, 10);
        let ended = end(RecordingEnd::ReceiverFailed(failed()), WriterEnd::Drained);
        assert_eq!(ended.failure(), Some(&failed()));
        let ended = end(RecordingEnd::WriterEnded, WriterEnd::Failed(failed()));
        assert_eq!(ended.word(), "a file could not be written");
        let ended = end(RecordingEnd::Stopped, WriterEnd::DiskFull(3));
        assert!(ended.failure().unwrap().sentence.contains("3 MB are free"));
        let ended = end(RecordingEnd::WriterEnded, WriterEnd::AllFrames);
        assert_eq!(ended.word(), "the limit is reached");
        assert_eq!(ended.failure(), None);
        let ended = end(RecordingEnd::Stopped, WriterEnd::Drained);
        assert_eq!(ended.word(), "stopped");
    }
}
