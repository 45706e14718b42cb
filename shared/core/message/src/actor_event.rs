//! What happens to the object actors.

use crate::{SCHEMA_VERSION, Text};
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// What happened, as a number in [`ActorEvent::kind`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ActorEventKind {
    /// The actor is ready, for the first time or again.
    Started = 1,
    /// Its life ended and another begins after a time.
    Restarting = 2,
    /// It ended and does not come back.
    Stopped = 3,
    /// It did not stop in time and was left behind.
    Abandoned = 4,
    /// Restarts exceeded the policy: the process ends.
    Escalated = 5,
}

impl ActorEventKind {
    const ALL: [Self; 5] = [
        Self::Started,
        Self::Restarting,
        Self::Stopped,
        Self::Abandoned,
        Self::Escalated,
    ];

    /// The number on the wire.
    pub fn code(self) -> u32 {
        self as u32
    }

    /// The kind of a number; `None` for any other number.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.code() == code)
    }

    /// The word for people and scripts.
    pub fn word(self) -> &'static str {
        match self {
            Self::Started => "started",
            Self::Restarting => "restarting",
            Self::Stopped => "stopped",
            Self::Abandoned => "abandoned",
            Self::Escalated => "escalated",
        }
    }
}

/// One event, with what the process has counted since its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.ActorEvent.v3")]
#[repr(C)]
pub struct ActorEvent {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: u32,
    /// Number of an [`ActorEventKind`].
    pub kind: u32,
    /// The track whose actor it is.
    pub track_id: u64,
    /// Sequence of the frame at work, which the track loses; meant when `has_frame`
    /// is 1.
    pub frame: u64,
    /// 1 when a frame was at work.
    pub has_frame: u32,
    /// Process id of the perception, which tells its lives apart.
    pub pid: u32,
    /// When the event was taken, monotonic.
    pub stamp_ns: u64,
    /// Time until the next life begins, nanoseconds; 0 but for `Restarting`.
    pub restart_after_ns: u64,
    /// Actors now.
    pub n_actors: u64,
    /// Restarts so far, this one included.
    pub n_restarts: u64,
    /// Actors left behind so far, this one included.
    pub n_abandoned: u64,
    /// Events that were lost so far, for nobody took them in time.
    pub n_lost: u64,
    /// Why; empty where nothing went wrong.
    pub cause: Text,
    /// Zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<ActorEvent>() == 216);

impl Default for ActorEvent {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            kind: 0,
            track_id: 0,
            frame: 0,
            has_frame: 0,
            pid: 0,
            stamp_ns: 0,
            restart_after_ns: 0,
            n_actors: 0,
            n_restarts: 0,
            n_abandoned: 0,
            n_lost: 0,
            cause: Text::default(),
            reserved: 0,
        }
    }
}

impl ActorEvent {
    /// What happened; `None` when the number is no kind.
    pub fn kind(&self) -> Option<ActorEventKind> {
        ActorEventKind::from_code(self.kind)
    }

    /// Sequence of the frame at work.
    pub fn frame(&self) -> Option<u64> {
        (self.has_frame == 1).then_some(self.frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_survive_the_border_and_others_are_none() {
        for kind in ActorEventKind::ALL {
            assert_eq!(ActorEventKind::from_code(kind.code()), Some(kind));
        }
        assert_eq!(ActorEvent::default().kind(), None);
        assert_eq!(ActorEventKind::from_code(u32::MAX), None);
    }

    #[test]
    fn a_frame_is_told_only_where_one_was_at_work() {
        let mut event = ActorEvent {
            frame: 7,
            ..ActorEvent::default()
        };
        assert_eq!(event.frame(), None);
        event.has_frame = 1;
        assert_eq!(event.frame(), Some(7));
    }
}
