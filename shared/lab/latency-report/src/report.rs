//! The report of a measurement.

use crate::batches::{Batch, batches};
use crate::measurement::{Measurement, StageSamples};
use crate::percentiles::Percentiles;
use crate::sum_check::SumCheck;
use crate::usage::Usage;
use crate::worst::WorstFrame;
use message::Stage;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Under which conditions was measured: all that the spans do not tell.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Conditions {
    /// Version of the program that measured.
    pub version: String,
    /// What the frames came from.
    pub source: String,
    /// Seconds since 1970 at the end of the measurement.
    pub measured_at_s: u64,
    /// What would make the figures untrue, a sentence each.
    pub warnings: Vec<String>,
    /// The daemon's processes.
    pub processes: Vec<ProcessReport>,
    /// Shared memory.
    pub shared_memory: SharedMemoryReport,
    /// The computer: fingerprint, and what else went on.
    pub machine: serde_json::Value,
}

/// What a process used while it was measured.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ProcessReport {
    /// Its short name.
    pub process: String,
    /// Its id.
    pub pid: u32,
    /// Processor time over time: 1 is one core.
    pub cores: f64,
    /// Resident memory at the end, megabytes.
    pub resident_mb: f64,
    /// Open files at the end.
    pub open_files: u64,
    /// Threads at the end.
    pub threads: u64,
    /// Page faults that read from disk.
    pub major_faults: u64,
    /// Page faults without disk.
    pub minor_faults: u64,
    /// How often its threads gave up a processor.
    pub voluntary_switches: u64,
    /// How often a processor was taken from its threads.
    pub involuntary_switches: u64,
}

/// What the domain has in shared memory.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SharedMemoryReport {
    /// Bytes that are in use.
    pub used_bytes: u64,
    /// Bytes that its limits come to.
    pub reserved_bytes: u64,
    /// Trace messages that came too fast to be read: their frames lack spans.
    pub lost_messages: u64,
}

/// What the measuring itself costs.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Measuring {
    /// Measured stages and waiting times of a frame, all processes.
    pub spans_per_frame: f64,
    /// Cost of measuring one stage, as timed on this computer.
    pub stage_cost_ns: f64,
    /// All that measuring costs a frame, milliseconds.
    pub cost_per_frame_ms: f64,
    /// The same as a share of the median end to end.
    pub share_of_frame: f64,
    /// Spans that found no place in their messages.
    pub left_out: u64,
    /// Spans that this version does not know.
    pub unknown: u64,
}

/// How many objects were seen.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Objects {
    /// Mean number in a frame.
    pub mean: f64,
    /// Most in a frame.
    pub max: u64,
}

/// What is known of one stage.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct StageReport {
    /// Durations of its passages, milliseconds.
    #[serde(flatten)]
    pub ms: Percentiles,
    /// Passages.
    pub count: u64,
    /// What all passages used.
    pub usage: Usage,
    /// The run in parts.
    pub batches: Vec<Batch>,
}

/// What a measurement has found.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Report {
    /// Instants at which a frame was due.
    pub frames: u64,
    /// Of these, frames of the source that got no labels.
    pub dropped: u64,
    /// Of these, instants for which the source had no frame.
    pub not_captured: u64,
    /// Time between two frames of the schedule, milliseconds.
    pub period_ms: f64,
    /// How long was measured, seconds.
    pub seconds: f64,
    /// Objects in the frames.
    pub objects: Objects,
    /// From the scheduled capture to the published labels.
    pub end_to_end_ms: Percentiles,
    /// End to end of the parts of the run.
    pub end_to_end_batches: Vec<Batch>,
    /// From the scheduled capture to the answer of each object's actor.
    pub object_label_ms: Percentiles,
    /// The stages, by their words.
    pub stages: BTreeMap<String, StageReport>,
    /// Whether the stages add up.
    pub sum_check: SumCheck,
    /// What the measuring costs.
    pub measuring: Measuring,
    /// The ten worst frames, worst first.
    pub worst: Vec<WorstFrame>,
    /// Under which conditions was measured.
    #[serde(flatten)]
    pub conditions: Conditions,
}

impl Report {
    /// The report of a measurement. Of `measuring` what the spans tell is filled in.
    pub fn new(measurement: &Measurement, measuring: &Measuring, conditions: Conditions) -> Self {
        let open_loop = measurement.open_loop();
        let n_frames = measurement.n_frames();
        let n_missed = open_loop.n_dropped + open_loop.n_not_captured;
        let end_to_end_ms = Percentiles::of(&mut measurement.end_to_end_ns(&open_loop));
        let mut labels_ns: Vec<u64> = measurement.labels.iter().map(|label| label.ns).collect();
        let stages: BTreeMap<_, _> = measurement
            .stages
            .iter()
            .map(|(stage, samples)| (*stage, stage_report(samples, n_frames)))
            .collect();
        let usual_ns = stages
            .iter()
            .map(|(stage, report)| (*stage, (report.ms.p50 * 1e6) as u64))
            .collect();
        Self {
            frames: n_frames as u64 + n_missed,
            dropped: open_loop.n_dropped,
            not_captured: open_loop.n_not_captured,
            period_ms: open_loop.period_ns as f64 / 1e6,
            seconds: measurement.span_ns() as f64 / 1e9,
            objects: Objects {
                mean: measurement.n_objects as f64 / n_frames.max(1) as f64,
                max: measurement.n_objects_max,
            },
            end_to_end_ms,
            end_to_end_batches: batches(&measurement.end_to_end, n_frames),
            object_label_ms: Percentiles::of(&mut labels_ns),
            sum_check: measurement.check,
            measuring: measuring_costs(measuring, measurement, end_to_end_ms.p50),
            worst: measurement.suspects.told(&usual_ns),
            stages: stages
                .into_iter()
                .map(|(stage, report)| (stage.word().to_owned(), report))
                .collect(),
            conditions,
        }
    }

    /// A stage, when it was passed.
    pub fn stage(&self, stage: Stage) -> Option<&StageReport> {
        self.stages.get(stage.word())
    }

    /// Processor time of the daemon over time, without the source: 1 is one core.
    pub fn cores_without_source(&self) -> f64 {
        let is_source =
            |process: &&ProcessReport| !["simulator", "camera"].contains(&process.process.as_str());
        let processes = self.conditions.processes.iter().filter(is_source);
        processes.map(|process| process.cores).sum()
    }
}

fn stage_report(stage: &StageSamples, n_frames: usize) -> StageReport {
    let mut durations_ns: Vec<u64> = stage.samples.iter().map(|sample| sample.ns).collect();
    StageReport {
        ms: Percentiles::of(&mut durations_ns),
        count: durations_ns.len() as u64,
        usage: stage.usage,
        batches: batches(&stage.samples, n_frames),
    }
}

/// A stage in which a thread worked costs a reading of its counters, all others only
/// stamps that are taken anyway; sending the spans is a stage of its own.
fn measuring_costs(measuring: &Measuring, measurement: &Measurement, frame_ms: f64) -> Measuring {
    let n_frames = measurement.n_frames().max(1) as f64;
    let n_spans: usize = measurement
        .stages
        .values()
        .map(|stage| stage.samples.len())
        .sum();
    let telling = measurement.stages.get(&Stage::Telling);
    let telling_ns: u64 = telling.map_or(0, |telling| {
        telling.samples.iter().map(|sample| sample.ns).sum()
    });
    let n_worked: u64 = measurement
        .stages
        .values()
        .map(|stage| stage.usage.worked)
        .sum();
    let cost_ns = n_worked as f64 * measuring.stage_cost_ns + telling_ns as f64;
    let cost_per_frame_ms = cost_ns / n_frames / 1e6;
    Measuring {
        spans_per_frame: n_spans as f64 / n_frames,
        cost_per_frame_ms,
        share_of_frame: if frame_ms > 0.0 {
            cost_per_frame_ms / frame_ms
        } else {
            0.0
        },
        ..measuring.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::way::examples::frame;

    fn report() -> Report {
        let mut measurement = Measurement::new(0);
        for sequence in (0..200).filter(|sequence| *sequence != 77) {
            measurement.add(frame(sequence, sequence * 33_000_000, sequence * 1000));
        }
        Report::new(&measurement, &Measuring::default(), Conditions::default())
    }

    #[test]
    fn the_document_has_the_promised_fields() {
        let report = report();
        let document = serde_json::to_value(&report).unwrap();
        assert_eq!(document["frames"], 200);
        assert_eq!(document["dropped"], 1);
        for percentile in ["p50", "p90", "p99", "p999", "max"] {
            assert!(document["end_to_end_ms"][percentile].is_f64());
            assert!(document["stages"]["detection"][percentile].is_f64());
        }
        assert!(document.get("machine").is_some());
        assert_eq!(serde_json::from_value::<Report>(document).unwrap(), report);
    }

    #[test]
    fn the_slowest_frame_is_the_missing_one_and_the_longest_after_it() {
        let report = report();
        assert!(report.end_to_end_ms.max > 43.0);
        assert_eq!(report.worst[0].sequence, 199);
        assert!(report.sum_check.passes());
    }
}
