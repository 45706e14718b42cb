//! Descriptive statistics of measurements and experiments.
//!
//! [`percentiles`] by nearest rank, [`spread`] of errors, [`correlation`], and [`bootstrap`]
//! confidence intervals.
//!
//! ```
//! use statistics::{bootstrap::Estimate, percentiles::Percentiles};
//!
//! let latencies_ms: Vec<f64> = (1..=100).map(f64::from).collect();
//! let percentiles = Percentiles::of(latencies_ms.clone()).unwrap();
//! assert_eq!((percentiles.p50, percentiles.p99), (50.0, 99.0));
//!
//! let runs: Vec<_> = latencies_ms.into_iter().map(Some).collect();
//! let mean = Estimate::mean(&runs, 1).unwrap();
//! assert!(mean.low < 50.5 && 50.5 < mean.high);
//! ```
//!
//! Invariants: no I/O, no clock; randomness comes from a seed.

pub mod bootstrap;
pub mod correlation;
pub mod percentiles;
pub mod spread;
