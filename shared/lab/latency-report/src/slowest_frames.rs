//! Slowest frames of a run, each with the probable cause.

use crate::frame_timeline::{FrameTimeline, StageInterval};
use message::{Stage, StageScope};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Number of slowest frames in the report.
pub(crate) const N_WORST: usize = 10;

/// Number of minor page faults above which they are reported as the cause. Chosen.
const MINOR_FAULTS_MAX: u32 = 50;

/// Slow frame with its probable cause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorstFrame {
    /// Session of the frame source.
    pub session: u64,
    /// Sequence number of the frame.
    pub sequence: u64,
    /// Latency from scheduled capture to published labels, milliseconds.
    pub end_to_end_ms: f64,
    /// Probable cause of the delay as one sentence.
    pub reason: String,
}

/// Candidate for the list of the slowest frames.
#[derive(Debug, Clone)]
pub(crate) struct SlowFrame {
    pub(crate) timeline: FrameTimeline,
    /// Publication time of the previous frame, monotonic clock; 0 for the first frame.
    pub(crate) before_published_ns: u64,
}

/// Slowest frames so far, slowest first.
#[derive(Debug, Default)]
pub(crate) struct SlowestFrames(Vec<SlowFrame>);

impl SlowestFrames {
    pub(crate) fn add(&mut self, timeline: &FrameTimeline, before_published_ns: u64) {
        let place = self
            .0
            .partition_point(|other| other.timeline.end_to_end_ns() >= timeline.end_to_end_ns());
        if place >= N_WORST {
            return;
        }
        self.0.truncate(N_WORST - 1);
        let slow = SlowFrame {
            timeline: timeline.clone(),
            before_published_ns,
        };
        self.0.insert(place, slow);
    }

    /// Reports with the probable cause of each slow frame, relative to the stages' usual
    /// durations, nanoseconds.
    pub(crate) fn explain(&self, usual_ns: &BTreeMap<Stage, u64>) -> Vec<WorstFrame> {
        let reports = |slow: &SlowFrame| WorstFrame {
            session: slow.timeline.session,
            sequence: slow.timeline.sequence,
            end_to_end_ms: ms(slow.timeline.end_to_end_ns().unwrap_or_default()),
            reason: reason(slow, usual_ns),
        };
        self.0.iter().map(reports).collect()
    }

    pub(crate) fn timelines(&self) -> impl Iterator<Item = &FrameTimeline> {
        self.0.iter().map(|slow| &slow.timeline)
    }
}

fn ms(ns: u64) -> f64 {
    ns as f64 / 1e6
}

/// Duration of an interval beyond the usual one, nanoseconds.
fn excess_ns(interval: &StageInterval, usual_ns: &BTreeMap<Stage, u64>) -> u64 {
    let usual = usual_ns.get(&interval.stage).copied().unwrap_or_default();
    interval.duration_ns().saturating_sub(usual)
}

fn most_delayed<'a>(
    intervals: impl Iterator<Item = &'a StageInterval>,
    usual_ns: &BTreeMap<Stage, u64>,
) -> Option<&'a StageInterval> {
    intervals.max_by_key(|interval| excess_ns(interval, usual_ns))
}

fn reason(slow: &SlowFrame, usual_ns: &BTreeMap<Stage, u64>) -> String {
    let timeline = &slow.timeline;
    let Some(link) = most_delayed(timeline.critical_path(), usual_ns) else {
        return "no stage of it was recorded".into();
    };
    let within = slowest_nested(timeline, link.stage, usual_ns);
    let cause = match link.stage {
        Stage::Source => late_source(timeline),
        Stage::Transport if slow.before_published_ns > link.span.begin_ns => {
            Some("perception was still at work on the frame before".into())
        }
        _ => Some(cause(within.unwrap_or(link))),
    };
    let describe = |interval: &StageInterval| {
        format!(
            "{}{} took {:.2} ms, {:.2} ms longer than usual",
            interval.stage.word(),
            of_track(interval),
            ms(interval.duration_ns()),
            ms(excess_ns(interval, usual_ns)),
        )
    };
    let parts = [
        Some(describe(link)),
        within.map(|step| format!("; in it {}", describe(step))),
        cause.map(|cause| format!(": {cause}")),
    ];
    parts.into_iter().flatten().collect()
}

/// Slowest interval nested in a stage of the critical path.
fn slowest_nested<'a>(
    timeline: &'a FrameTimeline,
    link: Stage,
    usual_ns: &BTreeMap<Stage, u64>,
) -> Option<&'a StageInterval> {
    let belongs = |interval: &&StageInterval| match interval.stage.scope() {
        StageScope::Within(whole) => whole == link,
        StageScope::Object => link == Stage::Objects && interval.stage != Stage::Barrier,
        StageScope::Frame | StageScope::Outside => false,
    };
    most_delayed(timeline.intervals.iter().filter(belongs), usual_ns)
}

fn of_track(interval: &StageInterval) -> String {
    match interval.span.track_id {
        0 => String::new(),
        track_id => format!(" of track {track_id}"),
    }
}

/// Cause of a delay by a late frame source.
fn late_source(timeline: &FrameTimeline) -> Option<String> {
    let making = timeline.interval(Stage::Generation)?;
    let waited = timeline.interval(Stage::ReleaseWait);
    let slept_ns = waited.map_or(0, StageInterval::duration_ns);
    Some(if making.span.end_ns > timeline.scheduled_ns {
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
fn cause(interval: &StageInterval) -> String {
    let span = &interval.span;
    if span.thread_id == 0 {
        return "it waited for a processor or a worker".into();
    }
    if span.n_major_faults > 0 {
        let n = span.n_major_faults;
        return format!("{n} page fault(s) read from disk");
    }
    let off_ns = interval.duration_ns().saturating_sub(span.cpu_ns);
    if off_ns > interval.duration_ns() / 4 {
        return format!(
            "its thread had no processor for {:.2} ms (preempted {} time(s), blocked {} time(s))",
            ms(off_ns),
            span.n_involuntary_switches,
            span.n_voluntary_switches,
        );
    }
    if span.n_minor_faults > MINOR_FAULTS_MAX {
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
    use crate::frame_timeline::test_frames::frame;

    fn usual() -> BTreeMap<Stage, u64> {
        let timeline = frame(0, 0, 0);
        let of = |interval: &StageInterval| (interval.stage, interval.duration_ns());
        timeline.intervals.iter().map(of).collect()
    }

    fn reason_of(timeline: &FrameTimeline, before_published_ns: u64) -> String {
        let mut slowest = SlowestFrames::default();
        slowest.add(timeline, before_published_ns);
        slowest.explain(&usual()).remove(0).reason
    }

    #[test]
    fn the_ten_slowest_are_kept_slowest_first() {
        let mut slowest = SlowestFrames::default();
        for sequence in 0..30 {
            slowest.add(&frame(sequence, 0, (sequence * 7 % 30) * 1_000_000), 0);
        }
        let reports = slowest.explain(&usual());
        let times: Vec<f64> = reports.iter().map(|frame| frame.end_to_end_ms).collect();
        let expected: Vec<f64> = (20..30).rev().map(|ms| 10.0 + f64::from(ms)).collect();
        assert_eq!(times, expected);
    }

    #[test]
    fn preempted_thread_is_reported_as_cause() {
        let mut timeline = frame(1, 0, 9_000_000);
        let detection = timeline
            .intervals
            .iter_mut()
            .find(|interval| interval.stage == Stage::Detection);
        let span = &mut detection.unwrap().span;
        (span.thread_id, span.cpu_ns, span.n_involuntary_switches) = (12, 7_000_000, 3);
        let reason = reason_of(&timeline, 0);
        assert!(
            reason.contains("detection took 16.00 ms, 9.00 ms longer"),
            "{reason}"
        );
        assert!(
            reason.contains("no processor for 9.00 ms (preempted 3"),
            "{reason}"
        );
    }

    #[test]
    fn previous_frame_is_reported_as_cause() {
        let mut timeline = frame(1, 0, 0);
        for interval in &mut timeline.intervals {
            if interval.stage == Stage::Transport {
                interval.span.end_ns += 5_000_000;
            }
        }
        let reason = reason_of(&timeline, 3_000_000);
        assert!(reason.contains("transport took 5.05 ms"), "{reason}");
        assert!(
            reason.contains("still at work on the frame before"),
            "{reason}"
        );
    }
}
