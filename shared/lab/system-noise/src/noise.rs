//! Probes of the noise floor. Each ends by itself after the given time.

pub mod bandwidth;
pub mod clock_cost;
pub mod hop;
pub mod interruptions;
pub mod load;
pub mod timer;
pub mod wake_up;
