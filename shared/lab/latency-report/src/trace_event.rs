//! Export of frames in the Trace Event Format for Perfetto and `chrome://tracing`.
//!
//! *Source*: Trace Event Format, Google, 2016: complete events (`X`) and metadata (`M`); times in
//! microseconds.

use crate::frame_timeline::{FrameTimeline, StageInterval};
use message::StageScope;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// First row number of rows that are no thread; Linux thread ids are smaller.
const CRITICAL_PATH_ROW: u64 = 1 << 32;

/// Trace document for Perfetto and `chrome://tracing`: a group per process with a row per thread,
/// a row for the critical path of the frames, and a row for the waiting times of each object.
pub fn chrome_trace(timelines: &[&FrameTimeline]) -> Value {
    let start_ns = timelines
        .iter()
        .flat_map(|timeline| &timeline.intervals)
        .map(|interval| interval.span.begin_ns)
        .min()
        .unwrap_or_default();
    let mut events = names(timelines);
    for timeline in timelines {
        let of_timeline = timeline
            .intervals
            .iter()
            .map(|interval| event(timeline, interval, start_ns));
        events.extend(of_timeline);
    }
    json!({ "displayTimeUnit": "ms", "traceEvents": events })
}

/// Row of an interval: its thread, the critical path, or the object.
fn row(interval: &StageInterval) -> u64 {
    match (interval.span.thread_id, interval.stage.scope()) {
        (0, StageScope::Object) => CRITICAL_PATH_ROW + 1 + interval.span.track_id,
        (0, _) | (_, StageScope::Frame) => CRITICAL_PATH_ROW,
        (thread_id, _) => thread_id.into(),
    }
}

fn row_name(interval: &StageInterval) -> String {
    match row(interval) {
        CRITICAL_PATH_ROW => "frame".into(),
        row if row > CRITICAL_PATH_ROW => format!("track {} waits", interval.span.track_id),
        thread_id => format!("thread {thread_id}"),
    }
}

fn names(timelines: &[&FrameTimeline]) -> Vec<Value> {
    let mut named = BTreeSet::new();
    let mut events = Vec::new();
    for interval in timelines.iter().flat_map(|timeline| &timeline.intervals) {
        if named.insert((interval.pid, None)) {
            let name = interval.process.program();
            events.push(json!({
                "ph": "M", "name": "process_name", "pid": interval.pid, "args": { "name": name },
            }));
        }
        if named.insert((interval.pid, Some(row(interval)))) {
            events.push(json!({
                "ph": "M", "name": "thread_name", "pid": interval.pid, "tid": row(interval),
                "args": { "name": row_name(interval) },
            }));
        }
    }
    events
}

fn event(timeline: &FrameTimeline, interval: &StageInterval, start_ns: u64) -> Value {
    let span = &interval.span;
    let us = |ns: u64| ns as f64 / 1e3;
    let mut arguments = json!({ "frame": timeline.sequence });
    if span.track_id != 0 {
        arguments["track"] = span.track_id.into();
    }
    if span.thread_id != 0 {
        arguments["cpu_us"] = us(span.cpu_ns).into();
        arguments["switches_voluntary"] = span.n_voluntary_switches.into();
        arguments["switches_involuntary"] = span.n_involuntary_switches.into();
        arguments["allocations"] = span.n_allocations.into();
        arguments["page_faults"] = (span.n_minor_faults + span.n_major_faults).into();
    }
    json!({
        "ph": "X",
        "name": interval.stage.word(),
        "cat": if span.thread_id == 0 { "waiting" } else { "work" },
        "ts": us(span.begin_ns.saturating_sub(start_ns)),
        "dur": us(interval.duration_ns()),
        "pid": interval.pid,
        "tid": row(interval),
        "args": arguments,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame_timeline::test_frames::frame;

    #[test]
    fn every_interval_is_an_event_and_every_row_has_a_name() {
        let timeline = frame(4, 5_000_000, 0);
        let document = chrome_trace(&[&timeline]);
        let events = document["traceEvents"].as_array().unwrap();
        let of_kind = |kind: &str| events.iter().filter(|e| e["ph"] == kind).count();
        assert_eq!(of_kind("X"), timeline.intervals.len());
        let rows: BTreeSet<u64> = events
            .iter()
            .filter(|event| event["ph"] == "X")
            .map(|event| event["tid"].as_u64().unwrap())
            .collect();
        let named = |line: &u64| {
            events
                .iter()
                .any(|e| e["name"] == "thread_name" && e["tid"] == *line)
        };
        assert!(rows.iter().all(named));
        let detection = events.iter().find(|e| e["name"] == "detection").unwrap();
        assert_eq!(detection["dur"], 7000.0);
    }

    #[test]
    fn no_frames_give_an_empty_trace() {
        assert_eq!(chrome_trace(&[])["traceEvents"], json!([]));
    }
}
