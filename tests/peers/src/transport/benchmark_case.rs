//! Who sends what to whom, how often.

use channel::topic::MAX_FRAME_POINTS;
use message::CloudPoint;
use std::time::Duration;

pub const POINT_BYTES: usize = size_of::<CloudPoint>();
/// Four points, a small cloud, a whole frame.
pub const PAYLOADS_BYTES: [usize; 3] = [64, 65_536, MAX_FRAME_POINTS * POINT_BYTES];
/// From here on a payload is sent at the rate of a camera.
const LARGE_BYTES: usize = 1_000_000;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum System {
    /// iceoryx2's ports; who sleeps does so in a tokio task.
    Iceoryx2,
    /// The same; who sleeps does so in `Listener::blocking_wait`.
    Iceoryx2Thread,
    /// The same with ports that threads may share, which ours are made of; polled.
    Iceoryx2Threadsafe,
    /// `shared/platform/channel`.
    Channel,
    UnixSocket,
    Zenoh,
    /// What a ROS 2 middleware without shared memory does with a cloud.
    RosLike,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// The receiver asks again and again.
    Polled,
    /// The receiver sleeps until it is woken.
    Blocking,
}

impl System {
    pub const ALL: [Self; 7] = [
        Self::Iceoryx2,
        Self::Iceoryx2Thread,
        Self::Iceoryx2Threadsafe,
        Self::Channel,
        Self::UnixSocket,
        Self::Zenoh,
        Self::RosLike,
    ];
    /// What the others are compared with.
    pub const REFERENCE: Self = Self::Iceoryx2;

    pub fn name(self) -> &'static str {
        match self {
            Self::Iceoryx2 => "iceoryx2",
            Self::Iceoryx2Thread => "iceoryx2-thread",
            Self::Iceoryx2Threadsafe => "iceoryx2-threadsafe",
            Self::Channel => "channel",
            Self::UnixSocket => "unix-socket",
            Self::Zenoh => "zenoh-shm",
            Self::RosLike => "ros-like",
        }
    }

    /// Whether it is measured in that mode.
    pub fn has(self, mode: Mode) -> bool {
        match self {
            Self::Iceoryx2 | Self::Channel | Self::UnixSocket => true,
            Self::Iceoryx2Threadsafe => mode == Mode::Polled,
            Self::Iceoryx2Thread | Self::Zenoh | Self::RosLike => mode == Mode::Blocking,
        }
    }
}

impl Mode {
    pub const ALL: [Self; 2] = [Self::Polled, Self::Blocking];

    pub fn name(self) -> &'static str {
        match self {
            Self::Polled => "polled",
            Self::Blocking => "blocking",
        }
    }
}

/// What one pair of processes does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Task {
    pub system: System,
    pub mode: Mode,
    pub payload_bytes: usize,
    /// Messages sent before those that count.
    pub n_warm_up: u64,
    /// Messages that count.
    pub n_messages: u64,
    /// From the sending of a message to that of the next.
    pub gap: Duration,
}

impl Task {
    /// `divisor` 10 sends a tenth of the messages.
    pub fn new(system: System, mode: Mode, payload_bytes: usize, divisor: u64) -> Self {
        let (n_messages, rate_hz) = match (mode, payload_bytes < LARGE_BYTES) {
            (Mode::Polled, true) => (5_000, 10_000),
            (Mode::Polled, false) => (300, 200),
            (Mode::Blocking, true) => (200, 200),
            (Mode::Blocking, false) => (90, 30),
        };
        Self {
            system,
            mode,
            payload_bytes,
            n_warm_up: 10,
            n_messages: n_messages / divisor,
            gap: Duration::from_secs(1) / rate_hz,
        }
    }

    pub fn n_all(&self) -> u64 {
        self.n_warm_up + self.n_messages
    }

    pub fn n_points(&self) -> usize {
        self.payload_bytes / POINT_BYTES
    }

    pub fn is_polled(&self) -> bool {
        self.mode == Mode::Polled
    }

    /// As words of a command line.
    pub fn words(&self) -> [String; 6] {
        [
            self.system.name().to_owned(),
            self.mode.name().to_owned(),
            self.payload_bytes.to_string(),
            self.n_warm_up.to_string(),
            self.n_messages.to_string(),
            self.gap.as_nanos().to_string(),
        ]
    }

    pub fn parse(words: &[String]) -> Option<Self> {
        let [system, mode, payload, warm_up, messages, gap] = words else {
            return None;
        };
        Some(Self {
            system: System::ALL.into_iter().find(|s| s.name() == system)?,
            mode: Mode::ALL.into_iter().find(|m| m.name() == mode)?,
            payload_bytes: payload.parse().ok()?,
            n_warm_up: warm_up.parse().ok()?,
            n_messages: messages.parse().ok()?,
            gap: Duration::from_nanos(gap.parse().ok()?),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_is_read_as_it_was_given() {
        for system in System::ALL {
            for (mode, payload_bytes) in Mode::ALL.into_iter().zip(PAYLOADS_BYTES) {
                let task = Task::new(system, mode, payload_bytes, 10);
                assert_eq!(Task::parse(&task.words()), Some(task));
            }
        }
        assert_eq!(Task::parse(&[]), None);
    }

    #[test]
    fn every_mode_has_what_the_others_are_compared_with() {
        assert!(Mode::ALL.iter().all(|&mode| System::REFERENCE.has(mode)));
        assert_eq!(System::ALL[0], System::REFERENCE);
    }
}
