//! Open-ended learning protocol with a simulated teacher: number of learned categories and speed
//! of learning.
//!
//! The teacher introduces categories one by one with a few views each. It then asks about the
//! introduced categories in turn and corrects each wrong answer at once by teaching the view of
//! the question. When the accuracy reaches a threshold, the next category is introduced. When it
//! stays too low, or unused views run out, the run ends.
//!
//! *Source*: Chauhan and Seabra Lopes, "Using spoken words to guide open-ended category
//! formation", Cognitive Processing 12, 2011; the rules in detail are those of the public code of
//! Kasaei's group.

mod curriculum;
mod learning_curves;
mod mean_curve;
mod protocol;
mod protocol_stage;
mod record;
mod summary;
mod teacher;

pub use curriculum::Exclusion;
pub use learning_curves::{overview_svg, run_svg};
pub use protocol::{Error, LessonSplit, Protocol};
pub use record::{Metrics, OpenEndedRun, Question, StageRecord, StopReason};
pub use summary::MetricsSummary;
pub use teacher::{run, usable_categories};

#[cfg(test)]
mod tests;
