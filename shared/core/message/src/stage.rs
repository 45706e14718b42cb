//! The stages of a frame's way, by name.

/// Where a stage lies between capture and label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A link of the frame's chain: these follow each other without gaps, from the
    /// scheduled capture to the published label.
    Frame,
    /// A link of each object's chain within [`Stage::Objects`].
    Object,
    /// A step within another stage.
    Within(Stage),
    /// Not between capture and label: before it, after it, or beside it.
    Beside,
}

macro_rules! stages {
    ($($(#[$doc:meta])* $stage:ident = $code:literal, $word:literal, $place:expr;)*) => {
        /// A stage that a frame or an object passes.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Stage {
            $($(#[$doc])* $stage = $code,)*
        }

        impl Stage {
            /// All stages, in the order of a frame's way.
            pub const ALL: &[Self] = &[$(Self::$stage),*];

            /// The word for people and scripts.
            pub fn word(self) -> &'static str {
                match self {
                    $(Self::$stage => $word,)*
                }
            }

            /// Where it lies.
            pub fn place(self) -> Place {
                match self {
                    $(Self::$stage => $place,)*
                }
            }
        }
    };
}

stages! {
    /// The source gets the next frame ready: it opens a file, or simulated time goes on.
    Preparing = 4, "preparing", Place::Beside;
    /// The frame is not begun yet: it is made as late as is safe.
    MakingWait = 5, "making_wait", Place::Beside;
    /// The source makes the frame: it reads the device, or renders.
    Making = 1, "making", Place::Beside;
    /// The made frame waits for its instant.
    ReleaseWait = 2, "release_wait", Place::Beside;
    /// The frame's header is written and the frame sent.
    Sending = 3, "sending", Place::Beside;
    /// From the scheduled instant to the frame in shared memory: how late the source
    /// is.
    Source = 10, "source", Place::Frame;
    /// From the frame in shared memory to perception having it: waking, and waiting
    /// for the frame before to be finished.
    Transport = 11, "transport", Place::Frame;
    /// Tracks are predicted, and people and robot placed at the frame's capture.
    Surroundings = 12, "surroundings", Place::Frame;
    /// Detection waits for a worker.
    DetectionQueue = 13, "detection_queue", Place::Frame;
    /// The objects are searched for.
    Detection = 14, "detection", Place::Frame;
    /// The finished detection waits for the frame loop.
    DetectionAnswer = 15, "detection_answer", Place::Frame;
    /// Candidates are given to tracks; actors of new tracks start.
    Association = 16, "association", Place::Frame;
    /// All objects' actors work on their views, until the last has answered.
    Objects = 17, "objects", Place::Frame;
    /// Key views are handed over, and objects and scene published.
    Publishing = 18, "publishing", Place::Frame;
    /// The points in range are sampled on a grid.
    Samples = 30, "samples", Place::Within(Stage::Detection);
    /// The plane of the table is found.
    TablePlane = 31, "table_plane", Place::Within(Stage::Detection);
    /// Cells and outline of the table.
    TableSurface = 32, "table_surface", Place::Within(Stage::Detection);
    /// The points over the table are listed.
    Prism = 33, "prism", Place::Within(Stage::Detection);
    /// They are joined to clusters, apart from people and robot.
    Clusters = 34, "clusters", Place::Within(Stage::Detection);
    /// Clusters of several objects are parted along creases.
    Piles = 35, "piles", Place::Within(Stage::Detection);
    /// Clusters are parted and joined by the tracks expected there.
    Regrouping = 36, "regrouping", Place::Within(Stage::Detection);
    /// Clusters grow down to the table.
    Feet = 37, "feet", Place::Within(Stage::Detection);
    /// Boxes around the clusters.
    Boxes = 38, "boxes", Place::Within(Stage::Detection);
    /// Constraints and rule; candidates are written.
    Judging = 39, "judging", Place::Within(Stage::Detection);
    /// Another worker helps with one of the steps before.
    Helping = 40, "helping", Place::Within(Stage::Detection);
    /// From the first object's question to this object's: the frame loop asks one
    /// after the other.
    HandOver = 50, "hand_over", Place::Object;
    /// The object's view waits for its actor and a worker.
    ActorQueue = 51, "actor_queue", Place::Object;
    /// The object's motion filter takes the measurement.
    Tracking = 52, "tracking", Place::Object;
    /// The object's points are described.
    Description = 53, "description", Place::Object;
    /// The description is compared with what was taught.
    Recognition = 54, "recognition", Place::Object;
    /// Whether the view is key; the points of a key view are packed.
    KeyView = 55, "key_view", Place::Object;
    /// The actor's answer waits for the frame loop.
    ActorAnswer = 56, "actor_answer", Place::Object;
    /// The object's answer is there, others are still missing.
    OthersAwaited = 57, "others_awaited", Place::Object;
    /// Posteriors are taken over, and key views handed to the outbox.
    Outbox = 70, "outbox", Place::Within(Stage::Publishing);
    /// Views and clouds of the objects, for those who subscribe.
    ObjectTopics = 71, "object_topics", Place::Within(Stage::Publishing);
    /// The scene with all labels.
    SceneTopic = 72, "scene_topic", Place::Within(Stage::Publishing);
    /// The spans of the frame before were published: what measuring costs.
    Telling = 73, "telling", Place::Beside;
    /// From the published label to another process having it.
    LabelHop = 90, "label_hop", Place::Beside;
    /// The scene waits until the working memory looks at it, a few times a second.
    WorldWait = 91, "world_wait", Place::Beside;
    /// The world model takes the scene over.
    WorldUpdate = 92, "world_update", Place::Beside;
}

impl Stage {
    /// The number on the wire.
    pub fn code(self) -> u32 {
        self as u32
    }

    /// The stage of a number; `None` for any other number.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.iter().copied().find(|stage| stage.code() == code)
    }

    /// The stage of a word.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|stage| stage.word() == word)
    }
}

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
    fn steps_lie_within_links_of_the_frames_chain() {
        for stage in Stage::ALL {
            if let Place::Within(whole) = stage.place() {
                assert_eq!(whole.place(), Place::Frame);
            }
        }
    }
}
