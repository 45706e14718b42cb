//! Slowest frames of a run, each with the probable cause.

use crate::way::{FrameWay, Passage};
use message::{Place, Stage};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Number of reported frames.
pub(crate) const N_WORST: usize = 10;

/// Number of minor page faults above which they are reported as the cause. Chosen.
const MANY_FAULTS: u32 = 50;

/// Slow frame with its probable cause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorstFrame {
    /// Session of the frame source.
    pub session: u64,
    /// Sequence number of the frame.
    pub sequence: u64,
    /// Latency from scheduled capture to published labels, milliseconds.
    pub end_to_end_ms: f64,
    /// Probable cause: one sentence.
    pub reason: String,
}

/// Candidate for the list of the slowest frames.
#[derive(Debug, Clone)]
pub(crate) struct Suspect {
    pub(crate) way: FrameWay,
    /// Publication time of the previous frame, monotonic clock; 0 for the first frame.
    pub(crate) before_published_ns: u64,
}

/// Slowest frames so far, slowest first.
#[derive(Debug, Default)]
pub(crate) struct Suspects(Vec<Suspect>);

impl Suspects {
    pub(crate) fn add(&mut self, way: &FrameWay, before_published_ns: u64) {
        let place = self
            .0
            .partition_point(|other| other.way.end_to_end_ns() >= way.end_to_end_ns());
        if place >= N_WORST {
            return;
        }
        self.0.truncate(N_WORST - 1);
        let suspect = Suspect {
            way: way.clone(),
            before_published_ns,
        };
        self.0.insert(place, suspect);
    }

    /// Reports with the probable cause of each slow frame, relative to the stages' usual
    /// durations, nanoseconds.
    pub(crate) fn told(&self, usual_ns: &BTreeMap<Stage, u64>) -> Vec<WorstFrame> {
        let told = |suspect: &Suspect| WorstFrame {
            session: suspect.way.session,
            sequence: suspect.way.sequence,
            end_to_end_ms: ms(suspect.way.end_to_end_ns().unwrap_or_default()),
            reason: reason(suspect, usual_ns),
        };
        self.0.iter().map(told).collect()
    }

    pub(crate) fn ways(&self) -> impl Iterator<Item = &FrameWay> {
        self.0.iter().map(|suspect| &suspect.way)
    }
}

fn ms(ns: u64) -> f64 {
    ns as f64 / 1e6
}

/// Duration of an interval beyond the usual one, nanoseconds.
fn excess_ns(passage: &Passage, usual_ns: &BTreeMap<Stage, u64>) -> u64 {
    let usual = usual_ns.get(&passage.stage).copied().unwrap_or_default();
    passage.duration_ns().saturating_sub(usual)
}

fn slowest<'a>(
    passages: impl Iterator<Item = &'a Passage>,
    usual_ns: &BTreeMap<Stage, u64>,
) -> Option<&'a Passage> {
    passages.max_by_key(|passage| excess_ns(passage, usual_ns))
}

fn reason(suspect: &Suspect, usual_ns: &BTreeMap<Stage, u64>) -> String {
    let way = &suspect.way;
    let Some(link) = slowest(way.links(), usual_ns) else {
        return "nothing is known of its way".into();
    };
    let within = within(way, link.stage, usual_ns);
    let cause = match link.stage {
        Stage::Source => late_source(way),
        Stage::Transport if suspect.before_published_ns > link.span.begin_ns => {
            Some("perception was still at work on the frame before".into())
        }
        _ => Some(cause(within.unwrap_or(link))),
    };
    let slow = |passage: &Passage| {
        format!(
            "{}{} took {:.2} ms, {:.2} ms longer than usual",
            passage.stage.word(),
            of_track(passage),
            ms(passage.duration_ns()),
            ms(excess_ns(passage, usual_ns)),
        )
    };
    let parts = [
        Some(slow(link)),
        within.map(|step| format!("; in it {}", slow(step))),
        cause.map(|cause| format!(": {cause}")),
    ];
    parts.into_iter().flatten().collect()
}

/// Slowest interval nested in a stage of the critical path.
fn within<'a>(
    way: &'a FrameWay,
    link: Stage,
    usual_ns: &BTreeMap<Stage, u64>,
) -> Option<&'a Passage> {
    let belongs = |passage: &&Passage| match passage.stage.place() {
        Place::Within(whole) => whole == link,
        Place::Object => link == Stage::Objects && passage.stage != Stage::OthersAwaited,
        Place::Frame | Place::Beside => false,
    };
    slowest(way.passages.iter().filter(belongs), usual_ns)
}

fn of_track(passage: &Passage) -> String {
    match passage.span.track_id {
        0 => String::new(),
        track_id => format!(" of track {track_id}"),
    }
}

/// Cause of a late frame source.
fn late_source(way: &FrameWay) -> Option<String> {
    let making = way.passage(Stage::Making)?;
    let waited = way.passage(Stage::ReleaseWait);
    let slept_ns = waited.map_or(0, Passage::duration_ns);
    Some(if making.span.end_ns > way.scheduled_ns {
        format!(
            "the source was not ready in time, it needed {:.2} ms to make the frame",
            ms(making.duration_ns())
        )
    } else {
        format!(
            "the frame was ready, but the source woke up late from waiting {:.2} ms",
            ms(slept_ns)
        )
    })
}

/// Cause of a slow interval, from the usage of its thread.
fn cause(passage: &Passage) -> String {
    let span = &passage.span;
    if span.thread_id == 0 {
        return "it waited for a processor or a worker".into();
    }
    if span.n_major_faults > 0 {
        let n = span.n_major_faults;
        return format!("{n} page fault(s) read from disk");
    }
    let off_ns = passage.duration_ns().saturating_sub(span.cpu_ns);
    if off_ns > passage.duration_ns() / 4 {
        return format!(
            "its thread had no processor for {:.2} ms (taken away {} time(s), given up {} time(s))",
            ms(off_ns),
            span.n_involuntary_switches,
            span.n_voluntary_switches,
        );
    }
    if span.n_minor_faults > MANY_FAULTS {
        let n = span.n_minor_faults;
        return format!("{n} page faults, the first use of memory");
    }
    format!(
        "it worked all the time, {:.2} ms of processor time",
        ms(span.cpu_ns)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::way::examples::frame;

    fn usual() -> BTreeMap<Stage, u64> {
        let way = frame(0, 0, 0);
        let of = |passage: &Passage| (passage.stage, passage.duration_ns());
        way.passages.iter().map(of).collect()
    }

    fn reason_of(way: &FrameWay, before_published_ns: u64) -> String {
        let mut suspects = Suspects::default();
        suspects.add(way, before_published_ns);
        suspects.told(&usual()).remove(0).reason
    }

    #[test]
    fn the_ten_longest_are_kept_longest_first() {
        let mut suspects = Suspects::default();
        for sequence in 0..30 {
            suspects.add(&frame(sequence, 0, (sequence * 7 % 30) * 1_000_000), 0);
        }
        let told = suspects.told(&usual());
        let times: Vec<f64> = told.iter().map(|frame| frame.end_to_end_ms).collect();
        let expected: Vec<f64> = (20..30).rev().map(|ms| 10.0 + f64::from(ms)).collect();
        assert_eq!(times, expected);
    }

    #[test]
    fn a_thread_without_processor_is_told() {
        let mut way = frame(1, 0, 9_000_000);
        let detection = way
            .passages
            .iter_mut()
            .find(|passage| passage.stage == Stage::Detection);
        let span = &mut detection.unwrap().span;
        (span.thread_id, span.cpu_ns, span.n_involuntary_switches) = (12, 7_000_000, 3);
        let reason = reason_of(&way, 0);
        assert!(
            reason.contains("detection took 16.00 ms, 9.00 ms longer"),
            "{reason}"
        );
        assert!(
            reason.contains("no processor for 9.00 ms (taken away 3"),
            "{reason}"
        );
    }

    #[test]
    fn a_frame_that_waited_for_the_one_before_is_told() {
        let mut way = frame(1, 0, 0);
        for passage in &mut way.passages {
            if passage.stage == Stage::Transport {
                passage.span.end_ns += 5_000_000;
            }
        }
        let reason = reason_of(&way, 3_000_000);
        assert!(reason.contains("transport took 5.05 ms"), "{reason}");
        assert!(
            reason.contains("still at work on the frame before"),
            "{reason}"
        );
    }
}
