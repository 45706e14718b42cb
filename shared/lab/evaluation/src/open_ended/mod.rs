//! The simulated teacher: how many categories are learned, and how fast.
//!
//! Category by category is introduced with a few views. Then the teacher asks,
//! one category after the other in the order of their introduction, and corrects
//! each wrong answer at once: the view that was asked is taught. When the share of
//! right answers is high enough, the next category comes. When it stays too low,
//! the run is over, and so it is without a fresh view.
//!
//! *Source*: Chauhan and Seabra Lopes, "Using spoken words to guide open-ended
//! category formation", Cognitive Processing 12, 2011; the rules in detail are
//! those of the public code of Kasaei's group.

mod curriculum;
mod figures;
mod protocol;
mod record;
mod stage;
mod summary;

pub use curriculum::LeftOut;
pub use figures::{overview_svg, run_svg};
pub use protocol::{Error, Protocol, Split, run, usable_categories};
pub use record::{Metrics, Question, Run, Stage, StopReason};
pub use summary::{MeanAndStd, Summary};

#[cfg(test)]
mod tests;
