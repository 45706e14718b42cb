//! Descriptive statistics of measurements and experiments.
//!
//! [`percentiles`] by nearest rank, [`spread`] of errors, and [`bootstrap`]
//! confidence intervals.
//!
//! Invariants: no I/O, no clock; randomness comes from a seed.

pub mod bootstrap;
pub mod percentiles;
pub mod spread;
