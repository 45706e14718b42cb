//! Timeline of one frame through the processes.

use message::{ProcessKind, Span, Stage, StageScope};
use std::collections::BTreeMap;

/// Interval of one processing stage in one process.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StageInterval {
    /// Processing stage that was executed.
    pub stage: Stage,
    /// Process that executed and recorded the stage.
    pub process: ProcessKind,
    /// Process id of the process that recorded the stage.
    pub pid: u32,
    /// Begin, end and resource usage of the stage.
    pub span: Span,
}

impl StageInterval {
    /// Duration of the stage in this frame, nanoseconds.
    pub fn duration_ns(&self) -> u64 {
        self.span.duration_ns()
    }
}

/// Timeline of one frame: all recorded stage intervals.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct FrameTimeline {
    /// Session of the frame source.
    pub session: u64,
    /// Sequence number of the frame within the session.
    pub sequence: u64,
    /// Scheduled publication by the source, monotonic clock, nanoseconds.
    pub scheduled_ns: u64,
    /// Recorded stage intervals in order of arrival.
    pub intervals: Vec<StageInterval>,
}

impl FrameTimeline {
    /// Intervals of the frame's critical path, which tile the end-to-end latency.
    pub fn critical_path(&self) -> impl Iterator<Item = &StageInterval> {
        let is_link = |interval: &&StageInterval| interval.stage.scope() == StageScope::Frame;
        self.intervals.iter().filter(is_link)
    }

    /// First recorded interval of a stage in this frame.
    pub fn interval(&self, stage: Stage) -> Option<&StageInterval> {
        self.intervals
            .iter()
            .find(|interval| interval.stage == stage)
    }

    /// Publication time of the labels, monotonic clock; `None` if they were not published.
    pub fn published_ns(&self) -> Option<u64> {
        Some(self.interval(Stage::Publishing)?.span.end_ns)
    }

    /// Latency from scheduled capture to published labels, nanoseconds.
    pub fn end_to_end_ns(&self) -> Option<u64> {
        Some(self.published_ns()?.saturating_sub(self.scheduled_ns))
    }

    /// Intervals of each object by track-id.
    pub fn objects(&self) -> BTreeMap<u64, Vec<&StageInterval>> {
        let mut objects: BTreeMap<u64, Vec<&StageInterval>> = BTreeMap::new();
        for interval in &self.intervals {
            if interval.stage.scope() == StageScope::Object {
                objects
                    .entry(interval.span.track_id)
                    .or_default()
                    .push(interval);
            }
        }
        objects
    }
}

#[cfg(test)]
pub(crate) mod test_frames {
    use super::*;

    /// Test interval of a stage in the perception process.
    pub(crate) fn interval(
        stage: Stage,
        track_id: u64,
        begin_ns: u64,
        end_ns: u64,
    ) -> StageInterval {
        StageInterval {
            stage,
            process: ProcessKind::PERCEPTION,
            pid: 7,
            span: Span::waiting(stage, track_id, begin_ns, end_ns),
        }
    }

    /// Frame with one object that takes 10 ms plus `longer_ns`, which its detection takes longer.
    pub(crate) fn frame(sequence: u64, scheduled_ns: u64, longer_ns: u64) -> FrameTimeline {
        let mut at_ns = scheduled_ns;
        let critical_path = [
            (Stage::Source, 100_000),
            (Stage::Transport, 50_000),
            (Stage::GatherPriors, 50_000),
            (Stage::DetectionQueue, 20_000),
            (Stage::Detection, 7_000_000 + longer_ns),
            (Stage::DetectionAnswer, 30_000),
            (Stage::Association, 250_000),
            (Stage::Objects, 2_000_000),
            (Stage::Publishing, 500_000),
        ];
        let mut intervals = Vec::new();
        for (stage, duration_ns) in critical_path {
            intervals.push(interval(stage, 0, at_ns, at_ns + duration_ns));
            if stage == Stage::Objects {
                let (begin, end) = (at_ns, at_ns + duration_ns);
                intervals.push(interval(Stage::ActorQueue, 3, begin, begin + 500_000));
                intervals.push(interval(Stage::Description, 3, begin + 500_000, end));
            }
            at_ns += duration_ns;
        }
        FrameTimeline {
            session: 1,
            sequence,
            scheduled_ns,
            intervals,
        }
    }
}
