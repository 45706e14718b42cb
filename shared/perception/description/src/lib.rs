//! Object descriptors: GOOD and the frame it is computed in.
//!
//! A descriptor is a vector of numbers that says what the visible surface of an
//! object looks like; similar objects have similar vectors. It is computed in a
//! frame of the object. [`Appearance`] is our own, with shape, size and colour; it
//! finds its frame itself. [`Good`] is the published one, with the frame of its
//! implementation, [`reference_frame`], where its numbers must be reproduced.
//!
//! This crate never copies an object's points except once into the frame of the
//! object, never allocates in steady state, never does I/O, and knows nothing
//! about categories or distances between descriptors.

mod object_points;

mod descriptor;
mod descriptor_frame;
mod error;

mod object_axes;
mod projected_points;
mod reference_frame;
mod reference_solver;

mod appearance;
mod good;

pub use appearance::{Appearance, AppearanceWeights, N_READINGS, WarpedGood};
pub use descriptor::Descriptor;
pub use descriptor_frame::DescriptorFrame;
pub use error::Error;
pub use good::{Good, GoodVariant, Support};
pub use object_axes::{AxesKind, ObjectAxes, object_axes};
pub use object_points::ObjectPoints;
pub use reference_frame::reference_frame;
