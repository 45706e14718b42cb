//! Experiments: what is measured, and how it is drawn.
//!
//! Each experiment is a function from its parameters to its figures, and a
//! function that draws them as SVG. The same parameters give the same figures.
//!
//! This crate never starts a process and knows nothing of channels.

mod figure;
pub mod sensor_error;

pub use figure::DrawingError;
