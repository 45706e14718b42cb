//! What this computer adds to every latency.
//!
//! [`Fingerprint`] says where a latency was measured, [`Disturbance`] what else went on
//! meanwhile, and [`warnings`] what of both makes figures untrue. [`noise`] has probes
//! of the noise floor, [`trial`](trial::trial) repeats two of them under real-time
//! settings, and [`effect`] and [`advice`](advice::advice) say what those bring here.
//! [`measure`] does all of it; [`report`] and [`figures`] show it.
//!
//! This crate never changes the computer: each setting is that of one of its own
//! threads or of its own memory, and is taken back by a guard. It writes no file
//! but those of a domain of its own in shared memory, which it removes, and never
//! fails because something can not be read.

pub mod advice;
mod disturbance;
pub mod effect;
pub mod figures;
mod fingerprint;
mod measurement;
pub mod noise;
mod privilege;
pub mod report;
mod samples;
mod scheduling;
mod system_call;
mod system_files;
pub mod trial;
mod warning;

pub use disturbance::{Disturbance, Watch};
pub use fingerprint::{BuildProfile, Fingerprint, FrequencyRange, Limit};
pub use measurement::{MachineReport, NotMeasured, Plan, measure};
pub use samples::{Samples, Summary};
pub use warning::{Warning, warnings};
