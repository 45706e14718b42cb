//! Benchmark cases: system under test, receive mode, payload size and message rate.

use channel::topic::MAX_FRAME_POINTS;
use message::CloudPoint;
use std::time::Duration;

/// Size of a point of a cloud, bytes.
pub const POINT_BYTES: usize = size_of::<CloudPoint>();
/// Payload sizes, bytes: four points, a small cloud, a whole frame.
pub const PAYLOADS_BYTES: [usize; 3] = [64, 65_536, MAX_FRAME_POINTS * POINT_BYTES];
/// Size, in bytes, from which a payload is sent at the rate of a camera.
const LARGE_BYTES: usize = 1_000_000;

/// Transport under test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum System {
    /// iceoryx2 ports; a blocking receiver sleeps in a tokio task.
    Iceoryx2,
    /// iceoryx2 ports; a blocking receiver sleeps in `Listener::blocking_wait`.
    Iceoryx2Thread,
    /// iceoryx2 ports that threads may share, like those of our channel; polled only.
    Iceoryx2Threadsafe,
    /// Publish-subscribe topic of `shared/platform/channel`.
    Channel,
    /// Unix stream socket.
    UnixSocket,
    /// zenoh peers with shared memory.
    Zenoh,
    /// Serialisation and copies of a ROS 2 middleware without shared memory.
    RosLike,
}

/// Waiting strategy of the receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReceiveMode {
    /// Busy polling.
    Polled,
    /// Sleep until woken by an event.
    Blocking,
}

impl System {
    /// All systems; the reference is first.
    pub const ALL: [Self; 7] = [
        Self::Iceoryx2,
        Self::Iceoryx2Thread,
        Self::Iceoryx2Threadsafe,
        Self::Channel,
        Self::UnixSocket,
        Self::Zenoh,
        Self::RosLike,
    ];
    /// Baseline of the ratios.
    pub const REFERENCE: Self = Self::Iceoryx2;

    /// Name on the command line and in reports.
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

    /// `true` if the system is measured in `mode`.
    pub fn supports(self, mode: ReceiveMode) -> bool {
        match self {
            Self::Iceoryx2 | Self::Channel | Self::UnixSocket => true,
            Self::Iceoryx2Threadsafe => mode == ReceiveMode::Polled,
            Self::Iceoryx2Thread | Self::Zenoh | Self::RosLike => mode == ReceiveMode::Blocking,
        }
    }
}

impl ReceiveMode {
    /// All modes.
    pub const ALL: [Self; 2] = [Self::Polled, Self::Blocking];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Polled => "polled",
            Self::Blocking => "blocking",
        }
    }
}

/// Task of one process pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BenchmarkCase {
    /// Transport under test.
    pub system: System,
    /// Waiting strategy of the receiver.
    pub mode: ReceiveMode,
    /// Size of the payload, bytes.
    pub payload_bytes: usize,
    /// Number of messages before the measurement.
    pub n_warm_up: u64,
    /// Number of measured messages.
    pub n_messages: u64,
    /// Interval between the sending of two messages.
    pub interval: Duration,
}

impl BenchmarkCase {
    /// Case with the number of messages divided by `divisor`.
    pub fn new(system: System, mode: ReceiveMode, payload_bytes: usize, divisor: u64) -> Self {
        let (n_messages, rate_hz) = match (mode, payload_bytes < LARGE_BYTES) {
            (ReceiveMode::Polled, true) => (5_000, 10_000),
            (ReceiveMode::Polled, false) => (300, 200),
            (ReceiveMode::Blocking, true) => (200, 200),
            (ReceiveMode::Blocking, false) => (90, 30),
        };
        Self {
            system,
            mode,
            payload_bytes,
            n_warm_up: 10,
            n_messages: n_messages / divisor,
            interval: Duration::from_secs(1) / rate_hz,
        }
    }

    /// Number of messages with the warm-up.
    pub fn n_all(&self) -> u64 {
        self.n_warm_up + self.n_messages
    }

    /// Size of the payload in points.
    pub fn n_points(&self) -> usize {
        self.payload_bytes / POINT_BYTES
    }

    /// `true` if the receiver polls.
    pub fn is_polled(&self) -> bool {
        self.mode == ReceiveMode::Polled
    }

    /// Command-line arguments of a child process.
    pub fn arguments(&self) -> [String; 6] {
        [
            self.system.name().to_owned(),
            self.mode.name().to_owned(),
            self.payload_bytes.to_string(),
            self.n_warm_up.to_string(),
            self.n_messages.to_string(),
            self.interval.as_nanos().to_string(),
        ]
    }

    /// Parses the arguments of a child process; `None` if invalid.
    pub fn parse(arguments: &[String]) -> Option<Self> {
        let [system, mode, payload, warm_up, messages, interval] = arguments else {
            return None;
        };
        Some(Self {
            system: System::ALL.into_iter().find(|s| s.name() == system)?,
            mode: ReceiveMode::ALL.into_iter().find(|m| m.name() == mode)?,
            payload_bytes: payload.parse().ok()?,
            n_warm_up: warm_up.parse().ok()?,
            n_messages: messages.parse().ok()?,
            interval: Duration::from_nanos(interval.parse().ok()?),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn case_round_trips_through_arguments() {
        for system in System::ALL {
            for (mode, payload_bytes) in ReceiveMode::ALL.into_iter().zip(PAYLOADS_BYTES) {
                let case = BenchmarkCase::new(system, mode, payload_bytes, 10);
                assert_eq!(BenchmarkCase::parse(&case.arguments()), Some(case));
            }
        }
        assert_eq!(BenchmarkCase::parse(&[]), None);
    }

    #[test]
    fn reference_supports_every_mode() {
        assert!(
            ReceiveMode::ALL
                .iter()
                .all(|&mode| System::REFERENCE.supports(mode))
        );
        assert_eq!(System::ALL[0], System::REFERENCE);
    }
}
