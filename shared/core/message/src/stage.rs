//! Stages of the frame pipeline, by name, for latency traces.

/// Scope of a stage within the path from capture to label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StageScope {
    /// Link of the frame's chain: consecutive without gaps, from the scheduled capture to the
    /// published label.
    Frame,
    /// Link of each object's chain within [`Stage::Objects`].
    Object,
    /// Sub-stage of another stage.
    Within(Stage),
    /// Outside the path from capture to label: before it, after it, or concurrent.
    Outside,
}

macro_rules! stages {
    ($($(#[$doc:meta])* $stage:ident = $code:literal, $word:literal, $place:expr;)*) => {
        /// Stage of the pipeline that a frame or an object passes.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Stage {
            $($(#[$doc])* $stage = $code,)*
        }

        impl Stage {
            /// All processing stages in pipeline order.
            pub const ALL: &[Self] = &[$(Self::$stage),*];

            /// Name of the stage, for people and scripts: that of the variant in snake case.
            pub fn word(self) -> &'static str {
                match self {
                    $(Self::$stage => $word,)*
                }
            }

            /// Scope of the stage: frame, object or part of another stage.
            pub fn scope(self) -> StageScope {
                match self {
                    $(Self::$stage => $place,)*
                }
            }
        }
    };
}

stages! {
    /// Preparation of the next frame by the source: opening a file, or advancing simulated time.
    Preparing = 4, "preparing", StageScope::Outside;
    /// Wait before frame generation, so that the frame is generated as late as is safe.
    GenerationWait = 5, "generation_wait", StageScope::Outside;
    /// Frame generation by the source: reading the device, or rendering.
    Generation = 1, "generation", StageScope::Outside;
    /// Wait of the finished frame for its release time.
    ReleaseWait = 2, "release_wait", StageScope::Outside;
    /// Sending of the frame, including its header.
    Sending = 3, "sending", StageScope::Outside;
    /// Source delay: from the scheduled time to the frame in shared memory.
    Source = 10, "source", StageScope::Frame;
    /// Transport delay: from the frame in shared memory to its receipt by perception, including
    /// wake-up and the wait for the previous frame.
    Transport = 11, "transport", StageScope::Frame;
    /// Gathering of priors: prediction of tracks, and poses of people and robot at capture time.
    GatherPriors = 12, "gather_priors", StageScope::Frame;
    /// Time in which detection waits for a worker.
    DetectionQueue = 13, "detection_queue", StageScope::Frame;
    /// Detection of table and candidates.
    Detection = 14, "detection", StageScope::Frame;
    /// Wait of the finished detection for the frame loop.
    DetectionAnswer = 15, "detection_answer", StageScope::Frame;
    /// Data association of candidates with tracks, including the start of actors for new tracks.
    Association = 16, "association", StageScope::Frame;
    /// Processing of all views by the object actors, until the last one answers.
    Objects = 17, "objects", StageScope::Frame;
    /// Publication of objects and scene, and hand-over of key views.
    Publishing = 18, "publishing", StageScope::Frame;
    /// Grid sampling of the points in range.
    Samples = 30, "samples", StageScope::Within(Stage::Detection);
    /// Search for the plane of the table.
    TablePlane = 31, "table_plane", StageScope::Within(Stage::Detection);
    /// Surface cells and outline of the table.
    TableSurface = 32, "table_surface", StageScope::Within(Stage::Detection);
    /// Selection of the points above the table (prism).
    Prism = 33, "prism", StageScope::Within(Stage::Detection);
    /// Clustering of these points, without people and robot.
    Clusters = 34, "clusters", StageScope::Within(Stage::Detection);
    /// Segmentation of the clusters into objects.
    Segmentation = 35, "segmentation", StageScope::Within(Stage::Detection);
    /// Split and merge of clusters by the tracks expected there.
    Regrouping = 36, "regrouping", StageScope::Within(Stage::Detection);
    /// Growth of clusters down to the table.
    SupportGrowth = 37, "support_growth", StageScope::Within(Stage::Detection);
    /// Fitting of oriented bounding boxes to the clusters.
    Boxes = 38, "boxes", StageScope::Within(Stage::Detection);
    /// Evaluation of constraints and rule; output of the candidates.
    ConstraintEvaluation = 39, "constraint_evaluation", StageScope::Within(Stage::Detection);
    /// Work of a second worker on one of the preceding steps.
    ParallelHelp = 40, "parallel_help", StageScope::Within(Stage::Detection);
    /// Dispatch delay: from the request to the first object until the request to this one, because
    /// the frame loop sends them one after the other.
    Dispatch = 50, "dispatch", StageScope::Object;
    /// Wait of the object's view for its actor and a worker.
    ActorQueue = 51, "actor_queue", StageScope::Object;
    /// Measurement update of the object's motion filter.
    Tracking = 52, "tracking", StageScope::Object;
    /// Computation of the object's descriptor.
    Description = 53, "description", StageScope::Object;
    /// Recognition: comparison of the descriptor with the stored views.
    Recognition = 54, "recognition", StageScope::Object;
    /// Key-view decision, and packing of a key view's points.
    KeyView = 55, "key_view", StageScope::Object;
    /// Wait of the actor's answer for the frame loop.
    ActorAnswer = 56, "actor_answer", StageScope::Object;
    /// Wait of an answered object for the remaining objects (barrier).
    Barrier = 57, "barrier", StageScope::Object;
    /// Adoption of the posteriors, and hand-over of key views to the outbox.
    Outbox = 70, "outbox", StageScope::Within(Stage::Publishing);
    /// Publication of views and clouds of single objects to subscribers.
    ObjectTopics = 71, "object_topics", StageScope::Within(Stage::Publishing);
    /// Publication of the scene with all labels.
    SceneTopic = 72, "scene_topic", StageScope::Within(Stage::Publishing);
    /// Publication of the previous frame's spans: cost of tracing itself.
    TracePublishing = 73, "trace_publishing", StageScope::Outside;
    /// Delivery delay: from the published label to its receipt by another process.
    LabelHop = 90, "label_hop", StageScope::Outside;
    /// Wait of the scene for the next update of the working memory, a few times per second.
    WorldWait = 91, "world_wait", StageScope::Outside;
    /// Update of the working memory from the scene.
    WorldUpdate = 92, "world_update", StageScope::Outside;
}

impl Stage {
    /// Wire code of the processing stage.
    pub fn code(self) -> u32 {
        self as u32
    }

    /// Stage of a wire code; `None` for an unknown code.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.iter().copied().find(|stage| stage.code() == code)
    }

    /// Stage of a name, present or earlier; `None` for an unknown name.
    pub fn from_word(word: &str) -> Option<Self> {
        let earlier = EARLIER_WORDS.iter().find(|(earlier, _)| *earlier == word);
        let word = earlier.map_or(word, |(_, stage)| stage.word());
        Self::ALL.iter().copied().find(|stage| stage.word() == word)
    }
}

/// Earlier names of stages, which stand in stored reports and budgets.
const EARLIER_WORDS: [(&str, Stage); 10] = [
    ("making_wait", Stage::GenerationWait),
    ("making", Stage::Generation),
    ("surroundings", Stage::GatherPriors),
    ("piles", Stage::Segmentation),
    ("feet", Stage::SupportGrowth),
    ("judging", Stage::ConstraintEvaluation),
    ("helping", Stage::ParallelHelp),
    ("hand_over", Stage::Dispatch),
    ("others_awaited", Stage::Barrier),
    ("telling", Stage::TracePublishing),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn numbers_and_words_name_one_stage_each() {
        let words: BTreeSet<_> = Stage::ALL.iter().map(|stage| stage.word()).collect();
        assert_eq!(words.len(), Stage::ALL.len());
        for &stage in Stage::ALL {
            assert_eq!(Stage::from_code(stage.code()), Some(stage));
            assert_eq!(Stage::from_word(stage.word()), Some(stage));
        }
        assert_eq!(Stage::from_code(0), None);
        assert_eq!(Stage::from_word(""), None);
    }

    #[test]
    fn words_are_the_names_of_the_variants_in_snake_case() {
        for stage in Stage::ALL {
            let capitals = |(index, letter): (usize, char)| {
                let separator = letter.is_uppercase() && index > 0;
                let letter = letter.to_lowercase();
                separator.then_some('_').into_iter().chain(letter)
            };
            let name = format!("{stage:?}");
            let word: String = name.chars().enumerate().flat_map(capitals).collect();
            assert_eq!(stage.word(), word);
        }
    }

    #[test]
    fn earlier_words_name_a_stage_and_are_no_present_ones() {
        for (word, stage) in EARLIER_WORDS {
            assert_eq!(Stage::from_word(word), Some(stage));
            assert!(Stage::ALL.iter().all(|stage| stage.word() != word));
        }
    }

    #[test]
    fn sub_stages_are_within_links_of_the_frame_chain() {
        for stage in Stage::ALL {
            if let StageScope::Within(whole) = stage.scope() {
                assert_eq!(whole.scope(), StageScope::Frame);
            }
        }
    }
}
