//! Outages of a source and of shared memory during capture: the loop tries again in place.
#![expect(clippy::unwrap_used, reason = "test helpers may panic")]

use capture::{CaptureEnd, CaptureLoop, FrameInfo, FramePace, FrameSize, Source, SourceError};
use channel::topic::MAX_FRAME_POINTS;
use channel::{Domain, Role, RunFolder};
use geometry::PinholeCamera;
use message::{ProcessKind, ProcessState};
use point_cloud::Point;
use service::{Context, Failure, HealthCounters, Home, Shutdown, exit_code};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{Sender, channel};

const SIZE: FrameSize = FrameSize {
    width: 4,
    height: 3,
};

/// Result of one attempt to prepare a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Attempt {
    /// The frame is fine.
    Frame,
    /// The source says that it cannot be used.
    Unusable,
    /// The frame is too large for the shared memory, so that no loan can be had.
    NoLoan,
    /// The frame is sent, and what follows it fails.
    FailsAfterSending,
}

/// Source that fails by a script, and then ends.
struct ScriptedSource {
    script: Vec<Attempt>,
    next: usize,
    /// Sequence numbers of the sent frames.
    sent: Sender<u64>,
}

impl ScriptedSource {
    fn attempt(&self) -> Attempt {
        self.script[self.next - 1]
    }
}

impl Source for ScriptedSource {
    fn name(&self) -> &'static str {
        "the scripted source"
    }

    fn rate_hz(&self) -> Option<f64> {
        Some(1000.0)
    }

    fn prepare(&mut self) -> Result<Option<FrameSize>, SourceError> {
        self.next += 1;
        match self.script.get(self.next - 1) {
            None => Ok(None),
            Some(Attempt::Unusable) => Err(SourceError::Unusable("the folder is away".into())),
            Some(Attempt::NoLoan) => Ok(Some(FrameSize {
                width: MAX_FRAME_POINTS,
                height: 2,
            })),
            Some(_) => Ok(Some(SIZE)),
        }
    }

    fn fill(&mut self, points: &mut [Point]) -> Result<FrameInfo, SourceError> {
        points.fill(Point::default());
        Ok(FrameInfo {
            camera: PinholeCamera {
                width: SIZE.width as u32,
                height: SIZE.height as u32,
                ..PinholeCamera::KINECT_V1
            },
            is_calibrated: true,
            world_from_camera: None,
            up_in_camera: None,
            source_frame: self.next,
            captured_ns: None,
        })
    }

    fn after_send(&mut self, header: &message::FrameHeader) -> Result<(), SourceError> {
        self.sent.send(header.sequence).unwrap();
        match self.attempt() {
            Attempt::FailsAfterSending => Err(SourceError::Unavailable("no shared memory".into())),
            _ => Ok(()),
        }
    }
}

static N_DOMAINS: AtomicU32 = AtomicU32::new(0);

/// End of the capture, state of the process, and sequence numbers of the sent frames.
struct Captured {
    end: Result<CaptureEnd, Failure>,
    state: ProcessState,
    sequences: Vec<u64>,
}

/// Captures from a scripted source in a domain of its own.
fn capture(script: &[Attempt]) -> Captured {
    let folder = tempfile::tempdir_in("/dev/shm").unwrap();
    let number = N_DOMAINS.fetch_add(1, Ordering::Relaxed);
    let name = format!("o{}-{number}", std::process::id()).parse().unwrap();
    let run_folder = RunFolder::at(folder.path().to_owned());
    let domain = Domain::join(&name, &run_folder, Role::Guest).unwrap();
    let health = Arc::new(HealthCounters::default());
    let context = Context {
        process: ProcessKind::CAMERA,
        domain,
        home: Home::at(folder.path().join("home")),
        shutdown: Shutdown::new().1,
        health: health.clone(),
    };
    let (sent, sequences) = channel();
    let source = Box::new(ScriptedSource {
        script: script.to_owned(),
        next: 0,
        sent,
    });
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let capture = CaptureLoop::new(
        context,
        source,
        FramePace::Schedule,
        runtime.handle().clone(),
    )
    .unwrap();
    let end = capture.run();
    Captured {
        end,
        state: health.state().0,
        sequences: sequences.try_iter().collect(),
    }
}

#[test]
fn failure_after_the_first_frame_is_tried_again_in_place() {
    for failure in [Attempt::Unusable, Attempt::NoLoan] {
        let captured = capture(&[Attempt::Frame, failure, failure, failure, Attempt::Frame]);
        assert_eq!(captured.end, Ok(CaptureEnd::EndOfRecording), "{failure:?}");
        assert_eq!(captured.sequences, [0, 1], "{failure:?}");
        assert_eq!(captured.state, ProcessState::Ready, "{failure:?}");
    }
}

#[test]
fn state_is_degraded_while_the_failure_lasts() {
    let captured = capture(&[Attempt::Frame, Attempt::NoLoan]);
    assert_eq!(captured.state, ProcessState::Degraded);
}

#[test]
fn unusable_source_before_the_first_frame_is_a_failure_of_the_start() {
    let captured = capture(&[Attempt::Unusable, Attempt::Frame]);
    let failure = captured.end.unwrap_err();
    assert_eq!(failure.code, exit_code::USAGE);
    assert!(captured.sequences.is_empty());
}

#[test]
fn number_of_a_sent_frame_is_not_used_again_when_what_follows_it_fails() {
    let captured = capture(&[Attempt::FailsAfterSending, Attempt::Frame]);
    assert_eq!(captured.sequences, [0, 1]);
}
