//! Integration tests of the public interface of the store.
//!
//! Tests named `long_` run the full counts; those next to them run a sample with the same code.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "the helpers of tests fail, and the children of tests talk, as tests do"
)]

mod archiving;
mod builders;
mod damage;
mod importing;
mod kill;
mod limits;
mod migration;
mod model;
mod names;
mod portable;
mod processes;
mod reading;
mod refusals;
mod round_trip;
mod thread;
mod undo;
mod undo_model;
