//! System noise: environment, disturbances and noise floor that this computer adds to every
//! latency.
//!
//! [`Fingerprint`] records the environment of a measurement, [`Disturbance`] the disturbances
//! during it, and [`warnings`] lists the findings that invalidate figures. [`measure`] adds the
//! noise floor, measured by the programs of the Debian packages `rt-tests` and `stress-ng`;
//! [`report`] and [`latency_histograms`] show it.
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
//! Invariants: this crate never changes the computer, and leaves no process and no file. An
//! unreadable system file or a missing program is never an error.

mod bandwidth;
mod disturbance;
mod fingerprint;
mod interruptions;
pub mod latency_histograms;
mod measurement;
mod measuring_program;
mod privilege;
mod process_counters;
pub mod report;
mod system_files;
mod timer_latency;
mod wake_up_delay;
mod warning;

pub use bandwidth::Bandwidth;
pub use disturbance::{Disturbance, DisturbanceMonitor};
pub use fingerprint::{BuildProfile, Fingerprint, FrequencyRange};
pub use interruptions::Interruptions;
pub use measurement::{MachineReport, MeasurementPlan, NotMeasured, measure};
pub use privilege::ResourceLimit;
pub use process_counters::ProcessCounters;
pub use timer_latency::{ThreadSetting, TimerTrial};
pub use wake_up_delay::{WakeUpDelay, WakeUpDelayMonitor};
pub use warning::{Warning, warnings};
