//! Document of a health report of a process.

use super::text;
use crate::document::document;
use message::{Health, ProcessKind, ProcessState};

document! {
    /// Health report of one process.
    HealthDocument = "tabula.Health" {
        /// Name of the process.
        process: String,
        /// Process id.
        pid: u32,
        /// State: starting, ready, degraded, idle or stopping.
        state: String,
        /// Explanation of the state; empty when nothing is wrong.
        note: String,
        /// Time of the report, monotonic clock, nanoseconds.
        stamp_ns: u64,
        /// Start time of the process, monotonic clock, nanoseconds.
        started_ns: u64,
        /// Number of frames published, processed or persisted.
        frames: u64,
        /// Number of frames dropped.
        frames_dropped: u64,
        /// Number of frames published more than a period late.
        frames_late: u64,
        /// Number of actor restarts.
        restarts: u64,
        /// Number of live actors.
        actors: u64,
        /// Number of abandoned workers.
        abandoned: u64,
        /// Resident memory, bytes.
        resident_bytes: u64,
    }
}

impl From<&Health> for HealthDocument {
    fn from(health: &Health) -> Self {
        let process = ProcessKind::from_code(health.process);
        let state = ProcessState::from_code(health.state);
        Self {
            process: process.map_or("unknown", ProcessKind::name).into(),
            pid: health.pid,
            state: state.map_or("unknown", ProcessState::word).into(),
            note: text(&health.note),
            stamp_ns: health.stamp_ns,
            started_ns: health.started_ns,
            frames: health.frames,
            frames_dropped: health.frames_dropped,
            frames_late: health.frames_late,
            restarts: health.restarts,
            actors: health.actors,
            abandoned: health.abandoned,
            resident_bytes: health.resident_bytes,
        }
    }
}
