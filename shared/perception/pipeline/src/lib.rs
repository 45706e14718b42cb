//! One frame's step as pure functions over explicit state.
//!
//! The step is written once: the perception process, evaluation, latency
//! measurements and demos all call it. It has two halves, because the second
//! runs once for every object, on any thread:
//!
//! 1. [`TrackTable::predict`] says where the tracks are expected, which detection
//!    has to know; [`TrackTable::step`] associates the candidates of the
//!    [`detection::Detection`] with them, begins new tracks for those of which the
//!    rule is true, and ends old ones.
//! 2. [`ObjectState::observe`] takes one object's measurement: motion filter,
//!    key-view rule, descriptor, recognition. Its [`Posterior`] goes back to the
//!    table ([`TrackTable::absorb`]).
//!
//! This crate never reads a clock, draws no random numbers, does no I/O, and
//! knows nothing of threads, actors or messages.

mod config;
mod departed;
mod error;
mod frame;
mod key_views;
mod object;
mod search;
mod track;
mod track_table;

pub use config::{Config, DESCRIPTOR_KIND, calibration, category_index};
pub use error::Error;
pub use frame::{Frame, Measured};
pub use object::{ObjectState, ObjectTools, Observation, Posterior, Stage, Stages};
pub use track::Track;
pub use track_table::{Sighting, Step, TrackTable};
