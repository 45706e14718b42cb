//! Where the time of a frame goes: spans of the stages it passes.

use crate::stage::Stage;
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// Most spans that a process tells of one frame: twenty for the frame, and six for
/// each of about 160 objects.
pub const MAX_SPANS: usize = 1024;

/// The frame that the spans of a message belong to, and who has worked on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.TraceHeader.v1")]
#[repr(C)]
pub struct TraceHeader {
    /// Number of a [`ProcessKind`](crate::ProcessKind).
    pub process: u32,
    /// Process id.
    pub pid: u32,
    /// Session of the source.
    pub session: u64,
    /// The frame.
    pub sequence: u64,
    /// When the source should have published it, monotonic.
    pub scheduled_ns: u64,
    /// Bits of [`frame_flag`](crate::frame_flag) of the frame.
    pub frame_flags: u32,
    /// Spans that found no place in this message.
    pub n_left_out: u32,
    /// Counts the messages of the port.
    pub sent: u64,
}

const _: () = assert!(size_of::<TraceHeader>() == 48);

/// A stage that was passed: when, and what it cost the thread that was at work.
///
/// What a stage used is 0 where it was spent waiting, for nobody was at work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.Span.v1")]
#[repr(C)]
pub struct Span {
    /// Begin, monotonic clock.
    pub begin_ns: u64,
    /// End, monotonic clock.
    pub end_ns: u64,
    /// The object's track; 0 where the stage is the frame's.
    pub track_id: u64,
    /// Processor time of the thread.
    pub cpu_ns: u64,
    /// Heap bytes requested by the thread.
    pub allocated_bytes: u64,
    /// Number of a [`Stage`].
    pub stage: u32,
    /// The kernel's number of the thread; 0 for waiting.
    pub thread_id: u32,
    /// Heap allocations of the thread.
    pub n_allocations: u32,
    /// How often the thread gave up its processor.
    pub n_voluntary_switches: u32,
    /// How often its processor was taken from it.
    pub n_involuntary_switches: u32,
    /// Page faults without disk.
    pub n_minor_faults: u32,
    /// Page faults that read from disk.
    pub n_major_faults: u32,
    /// Zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<Span>() == 72);

impl Span {
    /// Time that was spent waiting: nobody was at work.
    pub fn waiting(stage: Stage, track_id: u64, begin_ns: u64, end_ns: u64) -> Self {
        Self {
            begin_ns,
            end_ns,
            track_id,
            stage: stage.code(),
            ..Self::default()
        }
    }

    /// How long it took; 0 when the stamps are in no order.
    pub fn duration_ns(&self) -> u64 {
        self.end_ns.saturating_sub(self.begin_ns)
    }
}
