//! Latency trace of a frame, published on the topic `trace`.

use crate::detector::DetectedFrame;
use crate::frame_receiver::ReceivedFrame;
use crate::object_actors::SightingOutcome;
use channel::topic::{FrameTraces, Topic};
use channel::{Domain, Error};
use message::{ProcessKind, Span, Stage};
use service::{Stopwatch, TracePublisher, monotonic_ns};

/// Collector of the time spans of one frame.
///
/// Between the links of the chain no time is left out: each begins with the stamp
/// that ended the one before.
pub(crate) struct FrameTrace {
    publisher: TracePublisher,
    spans: Vec<Span>,
    /// Time span of publishing the trace of the previous frame.
    publishing: Option<Span>,
    /// End time of the stage chain so far, monotonic clock, nanoseconds.
    at_ns: u64,
}

impl FrameTrace {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            publisher: TracePublisher::new(domain, ProcessKind::PERCEPTION)?,
            spans: Vec::with_capacity(FrameTraces::MAX_ITEMS),
            publishing: None,
            at_ns: 0,
        })
    }

    /// Shared memory reserved by the publisher, bytes.
    pub(crate) fn reserved_bytes(&self) -> u64 {
        self.publisher.reserved_bytes()
    }

    /// Starts the trace of a received frame.
    pub(crate) fn begin(&mut self, received: &ReceivedFrame) {
        let header = received.frame.header();
        self.spans.clear();
        self.spans.extend(self.publishing.take());
        self.at_ns = header.scheduled_stamp_ns;
        self.end_wait(Stage::Source, header.published_stamp_ns);
        self.end_wait(Stage::Transport, received.received_ns);
    }

    /// End time of the stage chain so far, monotonic clock, nanoseconds.
    pub(crate) fn at_ns(&self) -> u64 {
        self.at_ns
    }

    /// Appends a working stage to the chain.
    pub(crate) fn end_work(&mut self, span: Span) {
        self.at_ns = span.end_ns;
        self.add(span);
    }

    /// Appends a waiting stage to the chain, which ends at `end_ns`.
    fn end_wait(&mut self, stage: Stage, end_ns: u64) {
        let span = Span::waiting(stage, 0, self.at_ns, end_ns);
        self.end_work(span);
    }

    /// Adds the spans of a finished detection.
    pub(crate) fn add_detection(&mut self, detected: &DetectedFrame) {
        let Some((whole, steps)) = detected.spans.split_last() else {
            return;
        };
        self.end_wait(Stage::DetectionQueue, whole.begin_ns);
        self.spans.extend_from_slice(steps);
        self.end_work(*whole);
        self.end_wait(Stage::DetectionAnswer, monotonic_ns());
    }

    /// Adds the spans of the object actors that answered in time.
    pub(crate) fn add_observations(&mut self, outcomes: &[SightingOutcome]) {
        let begin_ns = self.at_ns;
        self.end_wait(Stage::Objects, monotonic_ns());
        for (sighting, observed) in outcomes {
            let Some(observed) = observed else { continue };
            let (stamps, spans) = (&observed.stamps, &observed.spans);
            let waiting =
                |stage, begin_ns, end_ns| Span::waiting(stage, sighting.track_id, begin_ns, end_ns);
            let finished_ns = spans.last().map_or(stamps.begun_ns, |span| span.end_ns);
            self.add(waiting(Stage::Dispatch, begin_ns, stamps.asked_ns));
            self.add(waiting(Stage::ActorQueue, stamps.asked_ns, stamps.begun_ns));
            self.spans.extend_from_slice(spans);
            self.add(waiting(Stage::ActorAnswer, finished_ns, stamps.answered_ns));
            self.add(waiting(Stage::Barrier, stamps.answered_ns, self.at_ns));
        }
    }

    /// Adds a span that is no link of the chain.
    pub(crate) fn add(&mut self, span: Span) {
        self.spans.push(span);
    }

    /// Publishes the frame's latency spans.
    pub(crate) fn send(&mut self, received: &ReceivedFrame) {
        let mut watch = Stopwatch::start();
        self.publisher.send(received.frame.header(), &self.spans);
        self.publishing = Some(watch.lap(Stage::TracePublishing, 0));
    }
}
