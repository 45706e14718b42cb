//! Object descriptors: GOOD and the frame it is computed in.
//!
//! A descriptor is a vector of numbers that says what the visible surface of an
//! object looks like; similar objects have similar vectors. It is computed in a
//! frame of the object, which comes from [`object_frame`] in the live system,
//! and from [`reference_frame`] where numbers of the published implementation
//! must be reproduced.
//!
//! This crate never copies an object's points except once into the frame of the
//! object, never allocates in steady state, never does I/O, and knows nothing
//! about categories or distances between descriptors.

mod object_points;

mod descriptor;
mod descriptor_frame;
mod error;

mod object_frame;
mod reference_frame;
mod reference_solver;

mod good;

pub use descriptor::Descriptor;
pub use descriptor_frame::DescriptorFrame;
pub use error::Error;
pub use good::Good;
pub use object_frame::{ObjectFrame, object_frame};
pub use object_points::ObjectPoints;
pub use reference_frame::reference_frame;
