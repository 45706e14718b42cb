//! Publisher of latency traces of frames.

use channel::topic::{FrameTraces, Topic};
use channel::{Domain, Error, Publisher};
use message::{FrameHeader, ProcessKind, SceneSummary, Span, TraceHeader};

/// Publisher of the spans of frames on `trace`. It never waits for a reader: unread
/// spans are lost, and the reader counts them.
#[derive(Debug)]
pub struct TracePublisher {
    publisher: Publisher<FrameTraces>,
    process: ProcessKind,
    is_failure_logged: bool,
}

/// Frame to which spans belong.
#[derive(Debug, Clone, Copy)]
pub struct TracedFrame {
    session: u64,
    sequence: u64,
    scheduled_ns: u64,
    flags: u32,
}

impl From<&FrameHeader> for TracedFrame {
    fn from(header: &FrameHeader) -> Self {
        Self {
            session: header.session,
            sequence: header.sequence,
            scheduled_ns: header.scheduled_stamp_ns,
            flags: header.flags,
        }
    }
}

impl From<&SceneSummary> for TracedFrame {
    fn from(scene: &SceneSummary) -> Self {
        Self {
            session: scene.session,
            sequence: scene.sequence,
            scheduled_ns: scene.stamps.scheduled_ns,
            flags: scene.frame_flags,
        }
    }
}

impl TracePublisher {
    /// # Errors
    /// When the topic cannot be opened.
    pub fn new(domain: &Domain, process: ProcessKind) -> Result<Self, Error> {
        Ok(Self {
            publisher: Publisher::new(domain)?,
            process,
            is_failure_logged: false,
        })
    }

    /// Shared memory reserved by the publisher, bytes.
    pub fn reserved_bytes(&self) -> u64 {
        self.publisher.reservation().bytes()
    }

    /// Publishes the spans of one frame; spans above the limit are counted. A failure
    /// does not stop the process, and is logged once.
    pub fn send(&mut self, frame: impl Into<TracedFrame>, spans: &[Span]) {
        let frame = frame.into();
        let n_sent = spans.len().min(FrameTraces::MAX_ITEMS);
        let header = TraceHeader {
            process: self.process.code(),
            pid: std::process::id(),
            session: frame.session,
            sequence: frame.sequence,
            scheduled_ns: frame.scheduled_ns,
            frame_flags: frame.flags,
            n_left_out: (spans.len() - n_sent) as u32,
            sent: 0,
        };
        let sent = self.publisher.send_copy(header, &spans[..n_sent]);
        if let Err(error) = sent
            && !self.is_failure_logged
        {
            tracing::warn!("latency cannot be measured here: {error}");
            self.is_failure_logged = true;
        }
    }
}
