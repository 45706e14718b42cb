//! System noise: environment, disturbances and noise floor that this computer adds to every
//! latency.
//!
//! [`Fingerprint`] records the environment of a measurement, [`Disturbance`] the disturbances
//! during it, and [`warnings`] lists the findings that invalidate figures. [`probe`] measures the
//! noise floor, [`thread_setting`] repeats two of the probes under real-time settings, and
//! [`mitigation`] and [`recommendation`] evaluate those settings on this computer. [`measure`]
//! runs everything; [`report`] and [`latency_histograms`] show it.
//!
//! ```
//! use system_noise::{Disturbance, Fingerprint, warnings};
//!
//! let monitor = Disturbance::begin();
//! let sum: u64 = (0..1000).sum();
//! let disturbance = monitor.end(&[std::process::id()]);
//! for warning in warnings(&Fingerprint::read(), &disturbance) {
//!     println!("{warning}");
//! }
//! # assert_eq!(sum, 499_500);
//! ```
//!
//! Invariants: this crate never changes the computer. Each setting applies to one of its own
//! threads or to its own memory, and a guard reverts it. It writes no file except in a
//! shared-memory domain of its own, which it removes. An unreadable system file is never an
//! error.

mod disturbance;
mod fingerprint;
pub mod latency_histograms;
mod measurement;
pub mod mitigation;
mod privilege;
pub mod probe;
pub mod recommendation;
pub mod report;
mod samples;
mod scheduling;
mod system_call;
mod system_files;
pub mod thread_setting;
mod warning;

pub use disturbance::{Disturbance, DisturbanceMonitor};
pub use fingerprint::{BuildProfile, Fingerprint, FrequencyRange};
pub use measurement::{MachineReport, MeasurementPlan, NotMeasured, measure};
pub use privilege::ResourceLimit;
pub use samples::{LatencySummary, Samples};
pub use warning::{Warning, warnings};
