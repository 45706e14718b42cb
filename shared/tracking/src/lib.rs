//! Follows objects from frame to frame: motion filter, association, the life
//! of a track, and the rule for key views.
//!
//! Everything here is a plain value with pure functions over it, so that a
//! track's whole state can be copied as a checkpoint. Times are capture stamps
//! in nanoseconds, on any clock that does not run backwards.
//!
//! Invariants: this crate never reads a clock, never does I/O, draws no random
//! numbers, gives out no track-ids, and no input makes it panic or produce a
//! number that is not finite.

mod assignment;
mod association;
mod error;
mod key_view;
mod motion_filter;
mod track_life;

pub use assignment::{AssignmentBuffers, assign};
pub use association::{
    Appearance, AssociationBuffers, AssociationConfig, Observed, Predicted, associate,
};
pub use error::Error;
pub use key_view::{KeyViewRule, MotionPhase};
pub use motion_filter::{Measurement, MotionConfig, MotionFilter};
pub use track_life::{Place, TrackLife, TrackPhase};
