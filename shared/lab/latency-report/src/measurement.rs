//! Recorder of frame latencies during a measurement.

use crate::batches::Sample;
use crate::open_loop::{FrameEnd, OpenLoop};
use crate::sum_check::SumCheck;
use crate::usage::Usage;
use crate::way::FrameWay;
use crate::worst::Suspects;
use message::Stage;
use std::collections::{BTreeMap, VecDeque};

/// Durations and resource usage of all intervals of one stage.
#[derive(Debug, Default)]
pub(crate) struct StageSamples {
    pub(crate) samples: Vec<Sample>,
    pub(crate) usage: Usage,
}

/// Recorder of end-to-end and stage durations, resource usage, and selected whole frames.
#[derive(Debug)]
pub struct Measurement {
    n_kept: usize,
    kept: VecDeque<FrameWay>,
    pub(crate) frames: Vec<FrameEnd>,
    pub(crate) end_to_end: Vec<Sample>,
    pub(crate) labels: Vec<Sample>,
    pub(crate) stages: BTreeMap<Stage, StageSamples>,
    pub(crate) check: SumCheck,
    pub(crate) suspects: Suspects,
    pub(crate) n_objects: u64,
    pub(crate) n_objects_max: u64,
}

impl Measurement {
    /// Recorder that keeps the newest `n_kept` frames whole, in addition to the slowest ones.
    pub fn new(n_kept: usize) -> Self {
        Self {
            n_kept,
            kept: VecDeque::new(),
            frames: Vec::new(),
            end_to_end: Vec::new(),
            labels: Vec::new(),
            stages: BTreeMap::new(),
            check: SumCheck::default(),
            suspects: Suspects::default(),
            n_objects: 0,
            n_objects_max: 0,
        }
    }

    /// Number of frames with published labels so far.
    pub fn n_frames(&self) -> usize {
        self.frames.len()
    }

    /// Adds a frame, in order of session and sequence. A frame whose labels were not published is
    /// skipped; its gap is found later as a missed frame.
    pub fn add(&mut self, way: FrameWay) {
        let (Some(published_ns), Some(ns)) = (way.published_ns(), way.end_to_end_ns()) else {
            return;
        };
        let frame = self.frames.len() as u32;
        let before_published_ns = self.frames.last().map_or(0, |last| last.published_ns);
        self.frames.push(FrameEnd {
            session: way.session,
            sequence: way.sequence,
            scheduled_ns: way.scheduled_ns,
            published_ns,
        });
        self.end_to_end.push(Sample { frame, ns });
        self.check.add(&way);
        self.add_passages(&way, frame);
        self.suspects.add(&way, before_published_ns);
        if self.n_kept > 0 {
            if self.kept.len() == self.n_kept {
                self.kept.pop_front();
            }
            self.kept.push_back(way);
        }
    }

    fn add_passages(&mut self, way: &FrameWay, frame: u32) {
        let mut n_objects = 0;
        for passage in &way.passages {
            let stage = self.stages.entry(passage.stage).or_default();
            let ns = passage.duration_ns();
            stage.samples.push(Sample { frame, ns });
            stage.usage.add(&passage.span);
            if passage.stage == Stage::ActorAnswer {
                n_objects += 1;
                let ns = passage.span.end_ns.saturating_sub(way.scheduled_ns);
                self.labels.push(Sample { frame, ns });
            }
        }
        self.n_objects += n_objects;
        self.n_objects_max = self.n_objects_max.max(n_objects);
    }

    /// Frames kept whole, slowest and newest, in chronological order without duplicates.
    pub fn kept(&self) -> Vec<&FrameWay> {
        let all = self.suspects.ways().chain(&self.kept);
        let by_start: BTreeMap<_, _> = all
            .map(|way| ((way.scheduled_ns, way.session, way.sequence), way))
            .collect();
        by_start.into_values().collect()
    }

    /// Frames that were due and never came.
    pub fn open_loop(&self) -> OpenLoop {
        OpenLoop::of(&self.frames)
    }

    /// All end-to-end latencies, nanoseconds, including those of missed frames.
    pub fn end_to_end_ns(&self, open_loop: &OpenLoop) -> Vec<u64> {
        let came = self.end_to_end.iter().map(|sample| sample.ns);
        came.chain(open_loop.missed_ns.iter().copied()).collect()
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
    use crate::way::examples::frame;

    #[test]
    fn frames_are_counted_and_the_newest_and_worst_kept() {
        let mut measurement = Measurement::new(5);
        for sequence in 0..40 {
            let longer_ns = if sequence == 3 { 8_000_000 } else { 0 };
            measurement.add(frame(sequence, sequence * 33_000_000, longer_ns));
        }
        measurement.add(FrameWay::default());
        assert_eq!(measurement.n_frames(), 40);
        let kept: Vec<u64> = measurement.kept().iter().map(|way| way.sequence).collect();
        assert!(kept.contains(&3), "the worst is kept: {kept:?}");
        assert!(kept.ends_with(&[35, 36, 37, 38, 39]), "{kept:?}");
        assert_eq!((measurement.n_objects, measurement.n_objects_max), (0, 0));
        assert_eq!(measurement.span_ns(), 39 * 33_000_000);
    }

    #[test]
    fn a_dropped_frame_is_in_the_distribution() {
        let mut measurement = Measurement::new(0);
        for sequence in (0..10).filter(|sequence| *sequence != 6) {
            measurement.add(frame(sequence, sequence * 33_000_000, 0));
        }
        let open_loop = measurement.open_loop();
        assert_eq!(open_loop.n_dropped, 1);
        let mut all = measurement.end_to_end_ns(&open_loop);
        all.sort_unstable();
        assert_eq!(all.len(), 10);
        assert_eq!(all[9], 43_000_000, "until the labels of the next frame");
    }
}
