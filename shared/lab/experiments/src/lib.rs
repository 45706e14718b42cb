//! Experiments that run the perception kernels over generated and recorded data.
//!
//! [`Turntable`] generates single-object views for learning.

mod turntable;

pub use turntable::{CutOut, HEIGHTS, Turntable};
