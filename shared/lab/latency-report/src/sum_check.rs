//! Consistency check: stage durations must sum to the end-to-end latency within 1 %.

use crate::frame_timeline::{FrameTimeline, StageInterval};
use message::Stage;
use serde::{Deserialize, Serialize};

/// Tolerated gap or overlap of the stages, as a share of the end-to-end latency. Chosen.
const TOLERANCE: f64 = 0.01;

/// Result of the consistency check of stage durations against end-to-end latency.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SumCheck {
    /// Number of frames checked.
    pub frames: u64,
    /// Number of objects checked.
    pub objects: u64,
    /// Largest deviation of a frame's stages, as a share of its end-to-end latency.
    pub worst_frame_share: f64,
    /// Largest deviation of an object's stages, as a share of its frame's end-to-end latency.
    pub worst_object_share: f64,
    /// Number of frames and objects whose deviation exceeds 1 %.
    pub over: u64,
}

impl SumCheck {
    /// `true` if every deviation is within 1 %.
    pub fn passes(&self) -> bool {
        self.over == 0
    }

    /// Checks a frame and each of its objects. A frame without published labels is skipped.
    pub fn add(&mut self, timeline: &FrameTimeline) {
        let Some(end_to_end_ns) = timeline.end_to_end_ns() else {
            return;
        };
        let share = |sum_ns: u64, whole_ns: u64| {
            sum_ns.abs_diff(whole_ns) as f64 / end_to_end_ns.max(1) as f64
        };
        let links_ns = timeline
            .critical_path()
            .map(StageInterval::duration_ns)
            .sum();
        let of_frame = share(links_ns, end_to_end_ns);
        self.frames += 1;
        self.worst_frame_share = self.worst_frame_share.max(of_frame);
        self.over += u64::from(of_frame > TOLERANCE);
        let objects_ns = timeline
            .interval(Stage::Objects)
            .map_or(0, StageInterval::duration_ns);
        for chain in timeline.objects().values() {
            let of_object = share(
                chain.iter().map(|link| link.duration_ns()).sum(),
                objects_ns,
            );
            self.objects += 1;
            self.worst_object_share = self.worst_object_share.max(of_object);
            self.over += u64::from(of_object > TOLERANCE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame_timeline::test_frames::frame;

    #[test]
    fn stages_without_gaps_pass_the_check() {
        let mut check = SumCheck::default();
        check.add(&frame(0, 1_000, 0));
        assert!(check.passes());
        assert_eq!((check.frames, check.objects), (1, 1));
        assert_eq!(check.worst_frame_share, 0.0);
    }

    #[test]
    fn missing_stage_fails_the_check() {
        let without = |stage: Stage| {
            let mut timeline = frame(0, 1_000, 0);
            timeline
                .intervals
                .retain(|interval| interval.stage != stage);
            let mut check = SumCheck::default();
            check.add(&timeline);
            check
        };
        assert!(!without(Stage::Detection).passes());
        assert!(!without(Stage::Description).passes());
        assert!(without(Stage::GatherPriors).passes(), "0.5 % is tolerated");
        assert_eq!(without(Stage::Publishing).frames, 0);
    }
}
