//! Recorder of frame latencies during a measurement.

use crate::batch_means::Sample;
use crate::coordinated_omission::{FrameCompletion, MissedFrames};
use crate::frame_timeline::FrameTimeline;
use crate::resource_usage::ResourceUsage;
use crate::slowest_frames::SlowestFrames;
use crate::sum_check::SumCheck;
use message::Stage;
use std::collections::{BTreeMap, VecDeque};

/// Durations and resource usage of all intervals of one stage.
#[derive(Debug, Default)]
pub(crate) struct StageSamples {
    pub(crate) samples: Vec<Sample>,
    pub(crate) usage: ResourceUsage,
}

/// Recorder of end-to-end and stage durations, resource usage, and selected whole frames.
#[derive(Debug, Default)]
pub struct LatencyRecorder {
    n_kept: usize,
    kept: VecDeque<FrameTimeline>,
    pub(crate) frames: Vec<FrameCompletion>,
    pub(crate) end_to_end: Vec<Sample>,
    pub(crate) labels: Vec<Sample>,
    pub(crate) stages: BTreeMap<Stage, StageSamples>,
    pub(crate) check: SumCheck,
    pub(crate) slowest: SlowestFrames,
    pub(crate) n_objects: u64,
    pub(crate) n_objects_max: u64,
}

impl LatencyRecorder {
    /// Recorder that keeps the newest `n_kept` frames whole, in addition to the slowest ones.
    pub fn new(n_kept: usize) -> Self {
        Self {
            n_kept,
            ..Self::default()
        }
    }

    /// Number of frames with published labels so far.
    pub fn n_frames(&self) -> usize {
        self.frames.len()
    }

    /// Adds a frame, in order of session and sequence. A frame whose labels were not published is
    /// skipped; its gap is found later as a missed frame.
    pub fn add(&mut self, timeline: FrameTimeline) {
        let (Some(published_ns), Some(ns)) = (timeline.published_ns(), timeline.end_to_end_ns())
        else {
            return;
        };
        let frame = self.frames.len() as u32;
        let before_published_ns = self.frames.last().map_or(0, |last| last.published_ns);
        self.frames.push(FrameCompletion {
            session: timeline.session,
            sequence: timeline.sequence,
            scheduled_ns: timeline.scheduled_ns,
            published_ns,
        });
        self.end_to_end.push(Sample { frame, ns });
        self.check.add(&timeline);
        self.add_intervals(&timeline, frame);
        self.slowest.add(&timeline, before_published_ns);
        if self.n_kept > 0 {
            if self.kept.len() == self.n_kept {
                self.kept.pop_front();
            }
            self.kept.push_back(timeline);
        }
    }

    fn add_intervals(&mut self, timeline: &FrameTimeline, frame: u32) {
        let mut n_objects = 0;
        for interval in &timeline.intervals {
            let stage = self.stages.entry(interval.stage).or_default();
            let ns = interval.duration_ns();
            stage.samples.push(Sample { frame, ns });
            stage.usage.add(&interval.span);
            if interval.stage == Stage::ActorAnswer {
                n_objects += 1;
                let ns = interval.span.end_ns.saturating_sub(timeline.scheduled_ns);
                self.labels.push(Sample { frame, ns });
            }
        }
        self.n_objects += n_objects;
        self.n_objects_max = self.n_objects_max.max(n_objects);
    }

    /// Frames kept whole, slowest and newest, in chronological order without duplicates.
    pub fn kept(&self) -> Vec<&FrameTimeline> {
        let all = self.slowest.timelines().chain(&self.kept);
        let by_start: BTreeMap<_, _> = all
            .map(|timeline| {
                (
                    (timeline.scheduled_ns, timeline.session, timeline.sequence),
                    timeline,
                )
            })
            .collect();
        by_start.into_values().collect()
    }

    /// Frames that were due and never came.
    pub fn missed(&self) -> MissedFrames {
        MissedFrames::of(&self.frames)
    }

    /// All end-to-end latencies, nanoseconds, including those of missed frames.
    pub fn end_to_end_ns(&self, missed: &MissedFrames) -> Vec<u64> {
        let came = self.end_to_end.iter().map(|sample| sample.ns);
        came.chain(missed.missed_ns.iter().copied()).collect()
    }

    /// Durations of each stage, nanoseconds.
    pub fn stages_ns(&self) -> impl Iterator<Item = (Stage, Vec<u64>)> {
        self.stages.iter().map(|(stage, stage_samples)| {
            let samples = stage_samples.samples.iter();
            (*stage, samples.map(|sample| sample.ns).collect())
        })
    }

    /// Time from the first to the last frame's schedule, nanoseconds.
    pub fn span_ns(&self) -> u64 {
        match (self.frames.first(), self.frames.last()) {
            (Some(first), Some(last)) => last.scheduled_ns.saturating_sub(first.scheduled_ns),
            _ => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame_timeline::test_frames::frame;

    #[test]
    fn frames_are_counted_and_the_newest_and_worst_kept() {
        let mut recorder = LatencyRecorder::new(5);
        for sequence in 0..40 {
            let longer_ns = if sequence == 3 { 8_000_000 } else { 0 };
            recorder.add(frame(sequence, sequence * 33_000_000, longer_ns));
        }
        recorder.add(FrameTimeline::default());
        assert_eq!(recorder.n_frames(), 40);
        let kept: Vec<u64> = recorder
            .kept()
            .iter()
            .map(|timeline| timeline.sequence)
            .collect();
        assert!(kept.contains(&3), "the worst is kept: {kept:?}");
        assert!(kept.ends_with(&[35, 36, 37, 38, 39]), "{kept:?}");
        assert_eq!((recorder.n_objects, recorder.n_objects_max), (0, 0));
        assert_eq!(recorder.span_ns(), 39 * 33_000_000);
    }

    #[test]
    fn dropped_frames_enter_the_distribution() {
        let mut recorder = LatencyRecorder::new(0);
        for sequence in (0..10).filter(|sequence| *sequence != 6) {
            recorder.add(frame(sequence, sequence * 33_000_000, 0));
        }
        let missed = recorder.missed();
        assert_eq!(missed.n_dropped, 1);
        let mut all = recorder.end_to_end_ns(&missed);
        all.sort_unstable();
        assert_eq!(all.len(), 10);
        assert_eq!(all[9], 43_000_000, "until the labels of the next frame");
    }
}
