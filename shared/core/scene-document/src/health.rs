//! Document of the health of a process.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Health of one process of the daemon.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct HealthDocument {
    /// Name of the process: `camera`, `perception`, `memory` or `simulator`.
    pub process: String,
    /// Operating-system process id.
    pub pid: u32,
    /// State: `starting`, `ready`, `degraded`, `idle` or `stopping`.
    pub state: String,
    /// Time of the report, monotonic clock, nanoseconds.
    #[serde(default)]
    pub stamp_ns: u64,
    /// Start time of the process, monotonic clock, nanoseconds.
    #[serde(default)]
    pub started_ns: u64,
    /// Time since the process started, seconds.
    pub uptime_s: f64,
    /// Number of frames published or processed, or of scenes received by the memory.
    pub frames: u64,
    /// Number of frames dropped: due but not handled.
    pub frames_dropped: u64,
    /// Number of frames published more than a period late.
    pub frames_late: u64,
    /// Heap bytes allocated by the process since its start.
    pub allocated_bytes: u64,
    /// Resident memory of the process, bytes.
    pub resident_bytes: u64,
    /// Shared memory reserved by the publishers of the process, bytes.
    pub shared_memory_bytes: u64,
    /// Number of restarts within the process: of actors, and of lost jobs of the worker pool.
    pub restarts: u64,
    /// Number of live actors in the process.
    #[serde(default)]
    pub actors: u64,
    /// Number of abandoned worker threads.
    #[serde(default)]
    pub abandoned: u64,
    /// Explanation of the state as a sentence; empty when nothing is wrong.
    pub note: String,
}
