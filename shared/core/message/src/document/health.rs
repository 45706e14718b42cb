//! Document of the health of a process.

use crate::{Health, ProcessKind, ProcessState};
use scene_document::HealthDocument;

/// Document of a health report; `None` for another schema version.
pub fn health(health: &Health) -> Option<HealthDocument> {
    if health.schema_version != crate::SCHEMA_VERSION {
        return None;
    }
    let uptime_ns = health.stamp_ns.saturating_sub(health.started_ns);
    Some(HealthDocument {
        process: ProcessKind::from_code(health.process)?.word().into(),
        pid: health.pid,
        state: ProcessState::from_code(health.state)?.word().into(),
        stamp_ns: health.stamp_ns,
        started_ns: health.started_ns,
        uptime_s: uptime_ns as f64 * 1e-9,
        frames: health.frames,
        frames_dropped: health.frames_dropped,
        frames_late: health.frames_late,
        allocated_bytes: health.allocated_bytes,
        resident_bytes: health.resident_bytes,
        shared_memory_bytes: health.shared_memory_bytes,
        restarts: health.restarts,
        actors: health.actors,
        abandoned: health.abandoned,
        note: health.note.as_str().unwrap_or_default().into(),
    })
}
