//! Export of frames in the Trace Event Format for Perfetto and `chrome://tracing`.
//!
//! *Source*: Trace Event Format, Google, 2016: complete events (`X`) and metadata (`M`); times in
//! microseconds.

use crate::way::{FrameWay, Passage};
use message::Place;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// First row number of rows that are no thread; Linux thread ids are smaller.
const CHAIN_LINE: u64 = 1 << 32;

/// Trace document for Perfetto and `chrome://tracing`: a group per process with a row per thread,
/// a row for the critical path of the frames, and a row for the waiting times of each object.
pub fn timeline(ways: &[&FrameWay]) -> Value {
    let start_ns = ways
        .iter()
        .flat_map(|way| &way.passages)
        .map(|passage| passage.span.begin_ns)
        .min()
        .unwrap_or_default();
    let mut events = names(ways);
    for way in ways {
        let of_way = way
            .passages
            .iter()
            .map(|passage| event(way, passage, start_ns));
        events.extend(of_way);
    }
    json!({ "displayTimeUnit": "ms", "traceEvents": events })
}

/// Row of an interval: its thread, the critical path, or the object.
fn line(passage: &Passage) -> u64 {
    match (passage.span.thread_id, passage.stage.place()) {
        (0, Place::Object) => CHAIN_LINE + 1 + passage.span.track_id,
        (0, _) | (_, Place::Frame) => CHAIN_LINE,
        (thread_id, _) => thread_id.into(),
    }
}

fn line_name(passage: &Passage) -> String {
    match line(passage) {
        CHAIN_LINE => "frame".into(),
        line if line > CHAIN_LINE => format!("track {} waits", passage.span.track_id),
        thread_id => format!("thread {thread_id}"),
    }
}

fn names(ways: &[&FrameWay]) -> Vec<Value> {
    let mut told = BTreeSet::new();
    let mut events = Vec::new();
    for passage in ways.iter().flat_map(|way| &way.passages) {
        if told.insert((passage.pid, None)) {
            let name = passage.process.program();
            events.push(json!({
                "ph": "M", "name": "process_name", "pid": passage.pid, "args": { "name": name },
            }));
        }
        if told.insert((passage.pid, Some(line(passage)))) {
            events.push(json!({
                "ph": "M", "name": "thread_name", "pid": passage.pid, "tid": line(passage),
                "args": { "name": line_name(passage) },
            }));
        }
    }
    events
}

fn event(way: &FrameWay, passage: &Passage, start_ns: u64) -> Value {
    let span = &passage.span;
    let us = |ns: u64| ns as f64 / 1e3;
    let mut arguments = json!({ "frame": way.sequence });
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
        "name": passage.stage.word(),
        "cat": if span.thread_id == 0 { "waiting" } else { "work" },
        "ts": us(span.begin_ns.saturating_sub(start_ns)),
        "dur": us(passage.duration_ns()),
        "pid": passage.pid,
        "tid": line(passage),
        "args": arguments,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::way::examples::frame;

    #[test]
    fn every_passage_is_an_event_and_every_line_has_a_name() {
        let way = frame(4, 5_000_000, 0);
        let document = timeline(&[&way]);
        let events = document["traceEvents"].as_array().unwrap();
        let of_kind = |kind: &str| events.iter().filter(|e| e["ph"] == kind).count();
        assert_eq!(of_kind("X"), way.passages.len());
        let lines: BTreeSet<u64> = events
            .iter()
            .filter(|event| event["ph"] == "X")
            .map(|event| event["tid"].as_u64().unwrap())
            .collect();
        let named = |line: &u64| {
            events
                .iter()
                .any(|e| e["name"] == "thread_name" && e["tid"] == *line)
        };
        assert!(lines.iter().all(named));
        let detection = events.iter().find(|e| e["name"] == "detection").unwrap();
        assert_eq!(detection["dur"], 7000.0);
    }

    #[test]
    fn nothing_is_an_empty_timeline() {
        assert_eq!(timeline(&[])["traceEvents"], json!([]));
    }
}
