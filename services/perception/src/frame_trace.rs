//! Where the time of a frame goes, told on `trace`.

use crate::detector::Detected;
use crate::intake::Arrived;
use crate::observation_round::Outcome;
use channel::topic::{FrameTraces, Topic};
use channel::{Domain, Error};
use message::{ProcessKind, Span, Stage};
use service::{Stopwatch, TracePublisher, monotonic_ns};

/// Gathers the spans of one frame and publishes them with it.
///
/// Between the links of the chain no time is left out: each begins with the stamp
/// that ended the one before.
pub(crate) struct FrameTrace {
    publisher: TracePublisher,
    spans: Vec<Span>,
    /// What telling of the frame before has cost.
    telling: Option<Span>,
    /// Where the chain has come to.
    at_ns: u64,
}

impl FrameTrace {
    pub(crate) fn new(domain: &Domain) -> Result<Self, Error> {
        Ok(Self {
            publisher: TracePublisher::new(domain, ProcessKind::Perception)?,
            spans: Vec::with_capacity(FrameTraces::MAX_ITEMS),
            telling: None,
            at_ns: 0,
        })
    }

    /// Shared memory of the publisher.
    pub(crate) fn reserved_bytes(&self) -> u64 {
        self.publisher.reserved_bytes()
    }

    /// Begins a frame that has arrived.
    pub(crate) fn begin(&mut self, arrived: &Arrived) {
        let header = arrived.frame.header();
        self.spans.clear();
        self.spans.extend(self.telling.take());
        self.at_ns = header.scheduled_stamp_ns;
        self.waited(Stage::Source, header.published_stamp_ns);
        self.waited(Stage::Transport, arrived.received_ns);
    }

    /// Where the chain has come to, monotonic.
    pub(crate) fn at_ns(&self) -> u64 {
        self.at_ns
    }

    /// A link of the chain that has worked.
    pub(crate) fn worked(&mut self, span: Span) {
        self.at_ns = span.end_ns;
        self.tell(span);
    }

    /// A link of the chain that has ended now, or at `end_ns`, without work of its
    /// own.
    fn waited(&mut self, stage: Stage, end_ns: u64) {
        let span = Span::waiting(stage, 0, self.at_ns, end_ns);
        self.worked(span);
    }

    /// The detection has come back from its worker.
    pub(crate) fn detected(&mut self, detected: &Detected) {
        let Some((whole, steps)) = detected.spans.split_last() else {
            return;
        };
        self.waited(Stage::DetectionQueue, whole.begin_ns);
        self.spans.extend_from_slice(steps);
        self.worked(*whole);
        self.waited(Stage::DetectionAnswer, monotonic_ns());
    }

    /// All objects have answered that do so in time.
    pub(crate) fn observed(&mut self, outcomes: &[Outcome]) {
        let begin_ns = self.at_ns;
        self.waited(Stage::Objects, monotonic_ns());
        for (sighting, observed) in outcomes {
            let Some(observed) = observed else { continue };
            let (stamps, spans) = (&observed.stamps, &observed.spans);
            let waiting =
                |stage, begin_ns, end_ns| Span::waiting(stage, sighting.track_id, begin_ns, end_ns);
            let finished_ns = spans.last().map_or(stamps.begun_ns, |span| span.end_ns);
            self.tell(waiting(Stage::HandOver, begin_ns, stamps.asked_ns));
            self.tell(waiting(Stage::ActorQueue, stamps.asked_ns, stamps.begun_ns));
            self.spans.extend_from_slice(spans);
            self.tell(waiting(Stage::ActorAnswer, finished_ns, stamps.answered_ns));
            self.tell(waiting(
                Stage::OthersAwaited,
                stamps.answered_ns,
                self.at_ns,
            ));
        }
    }

    /// A span that is no link of the frame's chain.
    pub(crate) fn tell(&mut self, span: Span) {
        self.spans.push(span);
    }

    /// Publishes the frame's spans.
    pub(crate) fn send(&mut self, arrived: &Arrived) {
        let mut watch = Stopwatch::start();
        self.publisher.send(arrived.frame.header(), &self.spans);
        self.telling = Some(watch.lap(Stage::Telling, 0));
    }
}
