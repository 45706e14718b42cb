//! Document of a life-cycle event of an object actor.

use super::text;
use message::{ActorEvent, ActorEventKind};
use scene_document::Document;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Life-cycle event of an object actor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ActorEventDocument {
    /// Time of the event, monotonic clock, nanoseconds.
    pub stamp_ns: u64,
    /// Kind of the event: started, restarting, stopped, abandoned or escalated.
    pub kind: String,
    /// Track-id of the actor's object.
    pub track_id: u64,
    /// True if a frame was in progress.
    pub has_frame: bool,
    /// Sequence number of the frame in progress.
    pub frame: u64,
    /// Process id of perception.
    pub pid: u32,
    /// Number of live object actors.
    pub n_actors: u64,
    /// Number of restarts so far.
    pub n_restarts: u64,
    /// Number of abandoned actors so far.
    pub n_abandoned: u64,
    /// Delay until the restart, nanoseconds.
    pub restart_after_ns: u64,
    /// Cause of the failure; empty when nothing failed.
    pub cause: String,
}

impl From<&ActorEvent> for ActorEventDocument {
    fn from(event: &ActorEvent) -> Self {
        Self {
            stamp_ns: event.stamp_ns,
            kind: event.kind().map_or("unknown", ActorEventKind::word).into(),
            track_id: event.track_id,
            has_frame: event.frame().is_some(),
            frame: event.frame().unwrap_or_default(),
            pid: event.pid,
            n_actors: event.n_actors,
            n_restarts: event.n_restarts,
            n_abandoned: event.n_abandoned,
            restart_after_ns: event.restart_after_ns,
            cause: text(&event.cause),
        }
    }
}

impl Document for ActorEventDocument {
    const NAME: &'static str = "tabula.ActorEvent";
}
