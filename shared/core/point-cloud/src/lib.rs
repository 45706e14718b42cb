//! Points and organised clouds as borrowed views.
//!
//! A cloud is a slice of [`Point`]s; who owns the memory (a vector, a shared
//! frame, a file) is the caller's business. An organised cloud knows the image
//! grid it came from; a pixel without depth holds NaN coordinates.
//!
//! This crate never allocates per point and never does I/O.

mod organized_cloud;
mod point;
mod principal_axes;

pub use organized_cloud::{OrganizedCloud, SizeMismatch};
pub use point::{Point, Rgba};
pub use principal_axes::{Moments, PrincipalAxes};
