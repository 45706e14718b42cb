//! Health reports of the processes.

use crate::{SCHEMA_VERSION, Text};
use bytemuck::{AnyBitPattern, Zeroable};
use iceoryx2::prelude::ZeroCopySend;

coded_enum::coded_enum! {
    /// State of a process, as a code in [`Health::state`].
    pub enum ProcessState: u32 {
        /// Process is starting and not ready yet.
        Starting = 1, "starting";
        /// Process is ready and working.
        Ready = 2, "ready";
        /// Working with reduced function, explained in `note`.
        Degraded = 3, "degraded";
        /// Finished but still running, such as a camera whose recording has ended.
        Idle = 4, "idle";
        /// Process is shutting down.
        Stopping = 5, "stopping";
    }
}

/// Health report of one process: state and counters, sent every half second and at each change of
/// state.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.Health.v3")]
#[repr(C)]
pub struct Health {
    /// [`SCHEMA_VERSION`] of the sending program.
    pub schema_version: u32,
    /// Kind of the process: code of a [`ProcessKind`](crate::ProcessKind).
    pub process: u32,
    /// Operating-system process id.
    pub pid: u32,
    /// State of the process: code of a [`ProcessState`].
    pub state: u32,
    /// Start time of the process, monotonic clock, nanoseconds.
    pub started_ns: u64,
    /// Time of this report, monotonic clock, nanoseconds.
    pub stamp_ns: u64,
    /// Number of frames published (camera, simulator) or processed (perception), or of scenes
    /// received (memory).
    pub frames: u64,
    /// Number of frames, of scenes for memory, that were dropped: due but not handled.
    pub frames_dropped: u64,
    /// Number of frames published more than a period after their scheduled time (camera,
    /// simulator).
    pub frames_late: u64,
    /// Heap bytes allocated by the process since its start, freed ones included.
    pub allocated_bytes: u64,
    /// Number of heap allocations of the process since its start.
    pub allocations: u64,
    /// Resident memory of the process, shared memory included, bytes.
    pub resident_bytes: u64,
    /// Shared memory reserved by the publishers of the process, bytes.
    pub shared_memory_bytes: u64,
    /// Number of restarts within the process: of actors, and of lost jobs of the worker pool.
    pub restarts: u64,
    /// Number of live object actors.
    pub actors: u64,
    /// Number of worker threads abandoned because they made no progress.
    pub abandoned: u64,
    /// Progress counter, incremented by each step of real work and read by the watchdog.
    pub progress: u64,
    /// Explanation of the state as a sentence; empty when nothing is wrong.
    pub note: Text,
    /// Padding for alignment, zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<Health>() == 256);

impl Default for Health {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            state: ProcessState::Starting.code(),
            ..Self::zeroed()
        }
    }
}
