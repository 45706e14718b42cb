//! The store as its users see it.
//!
//! Tests named `long_` run the full counts; those beside them run a sample with
//! the same code.

mod builders;
mod damage;
mod kill;
mod model;
mod processes;
mod reading;
mod refusals;
mod round_trip;
mod thread;
