//! Probes of the noise floor. Each ends by itself after the given time.

pub mod bandwidth;
pub mod clock_cost;
pub mod cpu_load;
pub mod interruptions;
pub mod timer;
pub mod transport;
pub mod wake_up;
