//! Life-cycle events of the object actors.

use crate::{SCHEMA_VERSION, Text};
use bytemuck::{AnyBitPattern, Zeroable};
use iceoryx2::prelude::ZeroCopySend;

coded_enum::coded_enum! {
    /// Kind of a life-cycle event, as a code in [`ActorEvent::kind`].
    #[derive(Hash)]
    pub enum ActorEventKind: u32 {
        /// Actor is ready, after its first start or a restart.
        Started = 1, "started";
        /// Actor failed and restarts after a delay.
        Restarting = 2, "restarting";
        /// Actor ended and will not be restarted.
        Stopped = 3, "stopped";
        /// Actor did not stop within its deadline; its thread was abandoned.
        Abandoned = 4, "abandoned";
        /// Restarts exceeded the restart policy: the process ends.
        Escalated = 5, "escalated";
    }
}

/// Life-cycle event of an object actor, with the actor counters of the process.
#[derive(Debug, Clone, Copy, PartialEq, Eq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ActorEvent.v3")]
#[repr(C)]
pub struct ActorEvent {
    /// [`SCHEMA_VERSION`] of the sending program.
    pub schema_version: u32,
    /// Event kind: code of an [`ActorEventKind`].
    pub kind: u32,
    /// Track-id of the actor's object.
    pub track_id: u64,
    /// Sequence number of the frame in progress, which the track loses; valid when `has_frame` is
    /// 1.
    pub frame: u64,
    /// 1 when a frame was in progress.
    pub has_frame: u32,
    /// Process id of the perception process; distinguishes its runs.
    pub pid: u32,
    /// Time of the event, monotonic clock, nanoseconds.
    pub stamp_ns: u64,
    /// Delay until the restart, nanoseconds; 0 unless the kind is `Restarting`.
    pub restart_after_ns: u64,
    /// Number of live object actors.
    pub n_actors: u64,
    /// Number of restarts so far, including this one.
    pub n_restarts: u64,
    /// Number of abandoned actors so far, including this one.
    pub n_abandoned: u64,
    /// Number of events lost so far because the event queue was full.
    pub n_lost: u64,
    /// Cause of the failure; empty when nothing failed.
    pub cause: Text,
    /// Padding for alignment, zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<ActorEvent>() == 216);

impl Default for ActorEvent {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            ..Self::zeroed()
        }
    }
}

impl ActorEvent {
    /// Kind of the event; `None` for an unknown code.
    pub fn kind(&self) -> Option<ActorEventKind> {
        ActorEventKind::from_code(self.kind)
    }

    /// Sequence number of the frame in progress, if any.
    pub fn frame(&self) -> Option<u64> {
        (self.has_frame == 1).then_some(self.frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_survive_the_wire_and_others_are_none() {
        for kind in ActorEventKind::ALL {
            assert_eq!(ActorEventKind::from_code(kind.code()), Some(kind));
        }
        assert_eq!(ActorEvent::default().kind(), None);
        assert_eq!(ActorEventKind::from_code(u32::MAX), None);
    }

    #[test]
    fn frame_is_present_only_with_its_flag() {
        let mut event = ActorEvent {
            frame: 7,
            ..ActorEvent::default()
        };
        assert_eq!(event.frame(), None);
        event.has_frame = 1;
        assert_eq!(event.frame(), Some(7));
    }
}
