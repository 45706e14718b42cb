//! Integration tests: real processes, real shared memory, each test in a domain
//! of its own, cleaned up afterwards. A test ends only processes it has started.
#![cfg(test)]
#![expect(clippy::unwrap_used, reason = "helpers of tests panic as tests do")]

/// A daemon of a test's own.
mod daemon;
/// Folders of real data.
mod real_data;
/// Every scene of a domain, recorded.
mod scene_recorder;

/// Processes that are killed, stopped, or can not start.
mod faults;
/// A recording played through the real libfreenect.
mod fakenect;
/// Crates name only crates of lower layers; foreign libraries have owners.
mod layering;
/// Runs in lockstep repeat each other to the bit.
mod lockstep;
/// Start, see, teach, restart, recognise, stop.
mod skeleton;
/// The cloud is written once, and nobody allocates a frame's worth.
mod zero_copy;
