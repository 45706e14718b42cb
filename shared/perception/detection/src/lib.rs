//! Finds the objects on a table in one cloud.
//!
//! [`detect`] searches the table plane, keeps the points in the prism above
//! the table's polygon, joins them to clusters on the image grid, and returns
//! each cluster as a [`Candidate`] with an oriented box. Each candidate is judged
//! by every [`Constraint`]; an [`Expression`] over them says whether it is an
//! object that nobody knows yet. A cloud without an image grid is laid back on one
//! where it is a single view, and searched in voxels where it is not.
//!
//! Invariants: this crate never does I/O, never reads a clock, keeps no state
//! between frames but buffers, draws randomness only from the seed it is
//! given, accepts any bit pattern in the points, and knows of people, of the
//! robot and of tracks only the capsules and boxes it is given.

mod axis;
mod borders;
mod candidate;
mod clusters;
mod config;
mod constraint_evaluation;
mod creases;
mod crew;
mod detect;
mod error;
mod footprint;
mod islands;
mod lab;
mod outline;
mod patch;
mod piles;
mod plane_search;
mod prism;
mod samples;
mod step;
mod support;
mod table_plane;
mod table_region;
mod table_surface;
mod table_under;
mod unorganized;

pub use candidate::{Candidate, Support};
pub use config::{Config, InvalidConfig, RawConfig};
pub use crew::{Alone, Crew};
pub use detect::{
    Detection, ExpectedTrack, Frame, Surroundings, Workspace, detect, detect_in_steps,
};
pub use error::Error;
pub use outline::Outline;
pub use step::Step;
pub use table_plane::{Table, TableChoice};
