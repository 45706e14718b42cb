//! Latency report document (JSON).

use crate::batch_means::{Batch, batch_percentiles};
use crate::duration_percentiles::DurationPercentiles;
use crate::latency_recorder::{LatencyRecorder, StageSamples};
use crate::resource_usage::ResourceUsage;
use crate::slowest_frames::WorstFrame;
use crate::sum_check::SumCheck;
use message::Stage;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;

/// Conditions of a measurement: version, source, warnings, processes, machine.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Conditions {
    /// Version of the measuring program.
    pub version: String,
    /// Frame source of the measurement.
    pub source: String,
    /// End of the measurement, seconds since 1970 (Unix time).
    pub measured_at_s: u64,
    /// Reasons to distrust the figures, one sentence each.
    pub warnings: Vec<String>,
    /// Resource usage of the daemon's processes.
    pub processes: Vec<ProcessReport>,
    /// Shared memory of the domain.
    pub shared_memory: SharedMemoryReport,
    /// Environment fingerprint and disturbances of the computer, as JSON.
    pub machine: serde_json::Value,
}

/// Resource usage of one process during the measurement.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ProcessReport {
    /// Short name of the process.
    pub process: String,
    /// Operating-system process id.
    pub pid: u32,
    /// Mean CPU utilisation: processor time over elapsed time, 1 is one core.
    pub cores: f64,
    /// Resident memory at the end, megabytes.
    pub resident_mb: f64,
    /// Number of open files at the end.
    pub open_files: u64,
    /// Number of threads of the process at the end.
    pub threads: u64,
    /// Major page faults (read from disk).
    pub major_faults: u64,
    /// Minor page faults (no disk access).
    pub minor_faults: u64,
    /// Voluntary context switches of all threads.
    pub voluntary_switches: u64,
    /// Involuntary context switches of all threads.
    pub involuntary_switches: u64,
}

/// Shared-memory usage of the domain.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SharedMemoryReport {
    /// Shared memory in use, bytes.
    pub used_bytes: u64,
    /// Shared memory reserved by the limits, bytes.
    pub reserved_bytes: u64,
    /// Trace messages overwritten before they were read; the affected frames lack spans.
    pub lost_messages: u64,
}

/// Overhead of the measurement itself.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MeasurementOverhead {
    /// Spans per frame, all processes.
    pub spans_per_frame: f64,
    /// Cost of measuring one stage, as timed on this computer, nanoseconds.
    pub stage_cost_ns: f64,
    /// Total measurement overhead per frame, milliseconds.
    pub cost_per_frame_ms: f64,
    /// Total overhead as a share of the median end-to-end latency.
    pub share_of_frame: f64,
    /// Spans that did not fit into their messages.
    pub left_out: u64,
    /// Number of spans whose stage this version does not know.
    pub unknown: u64,
}

/// Number of objects per frame.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ObjectCounts {
    /// Mean number of objects per frame.
    pub mean: f64,
    /// Maximum number of objects in a frame.
    pub max: u64,
}

/// Latency statistics of one processing stage.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct StageReport {
    /// Percentiles of the stage's durations, milliseconds.
    #[serde(flatten)]
    pub ms: DurationPercentiles,
    /// Number of recorded executions of the stage.
    pub count: u64,
    /// Resource usage summed over all executions of the stage.
    pub usage: ResourceUsage,
    /// Percentiles of each batch of the run.
    pub batches: Vec<Batch>,
}

/// Report of one latency measurement.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LatencyReport {
    /// Number of scheduled captures (frames that were due).
    pub frames: u64,
    /// Captured frames that got no labels.
    pub dropped: u64,
    /// Scheduled captures without a frame from the source.
    pub not_captured: u64,
    /// Period of the frame schedule, milliseconds.
    pub period_ms: f64,
    /// Length of the measurement, seconds.
    pub seconds: f64,
    /// Number of objects in the frames.
    pub objects: ObjectCounts,
    /// Latency from scheduled capture to published labels.
    pub end_to_end_ms: DurationPercentiles,
    /// End-to-end percentiles of each batch of the run.
    pub end_to_end_batches: Vec<Batch>,
    /// Latency from scheduled capture to the answer of each object's actor.
    pub object_label_ms: DurationPercentiles,
    /// Statistics of the stages, by stage name.
    #[serde(deserialize_with = "by_stage_word")]
    pub stages: BTreeMap<String, StageReport>,
    /// Consistency check of stage durations against end-to-end latency.
    pub sum_check: SumCheck,
    /// Overhead of the measurement itself.
    #[serde(rename = "measuring")]
    pub overhead: MeasurementOverhead,
    /// Ten slowest frames, slowest first.
    pub worst: Vec<WorstFrame>,
    /// Conditions of the measurement.
    #[serde(flatten)]
    pub conditions: Conditions,
}

impl LatencyReport {
    /// Report of a recorded measurement. `overhead` gives the cost of a stage and the counts of
    /// lost spans; its other fields are computed here.
    pub fn new(
        recorder: &LatencyRecorder,
        overhead: &MeasurementOverhead,
        conditions: Conditions,
    ) -> Self {
        let missed = recorder.missed();
        let n_frames = recorder.n_frames();
        let n_missed = missed.n_dropped + missed.n_not_captured;
        let end_to_end_ms = DurationPercentiles::of(&mut recorder.end_to_end_ns(&missed));
        let mut labels_ns: Vec<u64> = recorder.labels.iter().map(|label| label.ns).collect();
        let stages: BTreeMap<_, _> = recorder
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
            dropped: missed.n_dropped,
            not_captured: missed.n_not_captured,
            period_ms: missed.period_ns as f64 / 1e6,
            seconds: recorder.span_ns() as f64 / 1e9,
            objects: ObjectCounts {
                mean: recorder.n_objects as f64 / n_frames.max(1) as f64,
                max: recorder.n_objects_max,
            },
            end_to_end_ms,
            end_to_end_batches: batch_percentiles(&recorder.end_to_end, n_frames),
            object_label_ms: DurationPercentiles::of(&mut labels_ns),
            sum_check: recorder.check,
            overhead: measurement_overhead(overhead, recorder, end_to_end_ms.p50),
            worst: recorder.slowest.explain(&usual_ns),
            stages: stages
                .into_iter()
                .map(|(stage, report)| (stage.word().to_owned(), report))
                .collect(),
            conditions,
        }
    }

    /// Statistics of a stage; `None` when it never occurred.
    pub fn stage(&self, stage: Stage) -> Option<&StageReport> {
        self.stages.get(stage.word())
    }

    /// CPU utilisation of the daemon without its frame source: 1 is one core.
    pub fn cores_without_source(&self) -> f64 {
        let is_source =
            |process: &&ProcessReport| !["simulator", "camera"].contains(&process.process.as_str());
        let processes = self.conditions.processes.iter().filter(is_source);
        processes.map(|process| process.cores).sum()
    }
}

/// Entries by the present names of stages; a document may have been written with earlier ones.
pub(crate) fn by_stage_word<'de, D, V>(document: D) -> Result<BTreeMap<String, V>, D::Error>
where
    D: Deserializer<'de>,
    V: Deserialize<'de>,
{
    let written = BTreeMap::<String, V>::deserialize(document)?;
    let present = |word: String| Stage::from_word(&word).map_or(word, |stage| stage.word().into());
    Ok(written
        .into_iter()
        .map(|(word, entry)| (present(word), entry))
        .collect())
}

fn stage_report(stage: &StageSamples, n_frames: usize) -> StageReport {
    let mut durations_ns: Vec<u64> = stage.samples.iter().map(|sample| sample.ns).collect();
    StageReport {
        ms: DurationPercentiles::of(&mut durations_ns),
        count: durations_ns.len() as u64,
        usage: stage.usage,
        batches: batch_percentiles(&stage.samples, n_frames),
    }
}

/// Computes the measurement overhead: a stage in which a thread worked costs one reading of its
/// counters, all other stages only time stamps that are taken anyway; sending the spans is a
/// stage of its own.
fn measurement_overhead(
    overhead: &MeasurementOverhead,
    recorder: &LatencyRecorder,
    frame_ms: f64,
) -> MeasurementOverhead {
    let n_frames = recorder.n_frames().max(1) as f64;
    let n_spans: usize = recorder
        .stages
        .values()
        .map(|stage| stage.samples.len())
        .sum();
    let publishing = recorder.stages.get(&Stage::TracePublishing);
    let publishing_ns: u64 = publishing.map_or(0, |publishing| {
        publishing.samples.iter().map(|sample| sample.ns).sum()
    });
    let n_worked: u64 = recorder
        .stages
        .values()
        .map(|stage| stage.usage.worked)
        .sum();
    let cost_ns = n_worked as f64 * overhead.stage_cost_ns + publishing_ns as f64;
    let cost_per_frame_ms = cost_ns / n_frames / 1e6;
    MeasurementOverhead {
        spans_per_frame: n_spans as f64 / n_frames,
        cost_per_frame_ms,
        share_of_frame: if frame_ms > 0.0 {
            cost_per_frame_ms / frame_ms
        } else {
            0.0
        },
        ..overhead.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame_timeline::test_frames::frame;

    fn report() -> LatencyReport {
        let mut recorder = LatencyRecorder::new(0);
        for sequence in (0..200).filter(|sequence| *sequence != 77) {
            recorder.add(frame(sequence, sequence * 33_000_000, sequence * 1000));
        }
        LatencyReport::new(
            &recorder,
            &MeasurementOverhead::default(),
            Conditions::default(),
        )
    }

    #[test]
    fn json_document_keeps_its_keys() {
        let report = report();
        let document = serde_json::to_value(&report).unwrap();
        assert_eq!(document["frames"], 200);
        assert_eq!(document["dropped"], 1);
        for percentile in ["p50", "p90", "p99", "p999", "max"] {
            assert!(document["end_to_end_ms"][percentile].is_f64());
            assert!(document["stages"]["detection"][percentile].is_f64());
        }
        assert!(document.get("machine").is_some());
        assert_eq!(
            serde_json::from_value::<LatencyReport>(document).unwrap(),
            report
        );
    }

    #[test]
    fn slowest_frame_is_the_one_after_a_gap() {
        let report = report();
        assert!(report.end_to_end_ms.max > 43.0);
        assert_eq!(report.worst[0].sequence, 199);
        assert!(report.sum_check.passes());
    }
}
