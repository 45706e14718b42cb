//! How a process says that it is well.

use crate::{SCHEMA_VERSION, Text};
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// The processes of the daemon, as a number in [`Health::process`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ProcessKind {
    /// `tabula-camera`
    Camera = 1,
    /// `tabula-perception`
    Perception = 2,
    /// `tabula-memory`
    Memory = 3,
    /// `tabula-simulator`, which stands in for the camera
    Simulator = 4,
}

impl ProcessKind {
    /// All processes, in the order they are started; of camera and simulator one
    /// runs at a time.
    pub const ALL: [Self; 4] = [
        Self::Memory,
        Self::Perception,
        Self::Camera,
        Self::Simulator,
    ];

    /// The number on the wire.
    pub fn code(self) -> u32 {
        self as u32
    }

    /// The process of a number; `None` for any other number.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|process| process.code() == code)
    }

    /// The short name: `camera`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Perception => "perception",
            Self::Memory => "memory",
            Self::Simulator => "simulator",
        }
    }

    /// The program's file name: `tabula-camera`.
    pub fn program(self) -> String {
        format!("tabula-{}", self.name())
    }
}

/// What a process is doing, as a number in [`Health::state`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProcessState {
    /// Not ready to work.
    Starting = 1,
    /// Working.
    Ready = 2,
    /// Working with a loss, which `note` explains.
    Degraded = 3,
    /// Finished with its work and still there (a recording that has ended).
    Idle = 4,
    /// Going away.
    Stopping = 5,
}

impl ProcessState {
    const ALL: [Self; 5] = [
        Self::Starting,
        Self::Ready,
        Self::Degraded,
        Self::Idle,
        Self::Stopping,
    ];

    /// The number on the wire.
    pub fn code(self) -> u32 {
        self as u32
    }

    /// The state of a number; `None` for any other number.
    pub fn from_code(code: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|state| state.code() == code)
    }

    /// The word for people and scripts.
    pub fn word(self) -> &'static str {
        match self {
            Self::Starting => "starting",
            Self::Ready => "ready",
            Self::Degraded => "degraded",
            Self::Idle => "idle",
            Self::Stopping => "stopping",
        }
    }
}

/// State and counters of one process, about once a second.
#[derive(Debug, Clone, Copy, PartialEq, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.Health.v3")]
#[repr(C)]
pub struct Health {
    /// [`SCHEMA_VERSION`] of the writer.
    pub schema_version: u32,
    /// Number of a [`ProcessKind`].
    pub process: u32,
    /// Process id.
    pub pid: u32,
    /// Number of a [`ProcessState`].
    pub state: u32,
    /// When the process started, monotonic.
    pub started_ns: u64,
    /// When this was written, monotonic.
    pub stamp_ns: u64,
    /// Frames published (camera), processed (perception), persisted (memory).
    pub frames: u64,
    /// Frames the process should have handled and has not.
    pub frames_dropped: u64,
    /// Frames published after their scheduled time by more than a period.
    pub frames_late: u64,
    /// Heap bytes requested since start.
    pub allocated_bytes: u64,
    /// Heap allocations since start.
    pub allocations: u64,
    /// Memory resident now, bytes.
    pub resident_bytes: u64,
    /// Bytes of shared memory its publishers have reserved.
    pub shared_memory_bytes: u64,
    /// Restarts inside the process (object actors).
    pub restarts: u64,
    /// Actors now.
    pub actors: u64,
    /// Worker threads that were left behind, for they showed no progress.
    pub abandoned: u64,
    /// Bumped by each step of real progress; what the watchdog looks at.
    pub progress: u64,
    /// A sentence about the state, empty when all is well.
    pub note: Text,
    /// Zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<Health>() == 256);

impl Default for Health {
    fn default() -> Self {
        Self {
            schema_version: SCHEMA_VERSION,
            process: 0,
            pid: 0,
            state: ProcessState::Starting.code(),
            started_ns: 0,
            stamp_ns: 0,
            frames: 0,
            frames_dropped: 0,
            frames_late: 0,
            allocated_bytes: 0,
            allocations: 0,
            resident_bytes: 0,
            shared_memory_bytes: 0,
            restarts: 0,
            actors: 0,
            abandoned: 0,
            progress: 0,
            note: Text::default(),
            reserved: 0,
        }
    }
}
