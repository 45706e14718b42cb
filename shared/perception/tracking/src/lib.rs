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
mod axis_filter;
mod color_histogram;
mod depth_view;
mod error;
mod evidence;
mod faces;
mod key_view;
mod measurement;
mod motion_filter;
mod orientation;
mod track_life;

pub use assignment::{AssignmentBuffers, assign};
pub use association::{
    Appearance, AssociationBuffers, AssociationConfig, Observed, Predicted, associate, look_cost,
    share_inside,
};
pub use color_histogram::ColorHistogram;
pub use depth_view::DepthView;
pub use error::Error;
pub use evidence::Evidence;
pub use key_view::{KeyViewRule, MotionPhase};
pub use measurement::{Circumstances, Handling, Measurement};
pub use motion_filter::{MotionConfig, MotionFilter};
pub use track_life::{Place, Sight, TrackLife, TrackPhase};
