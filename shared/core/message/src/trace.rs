//! Latency traces: spans of the stages that a frame passes.

use crate::stage::Stage;
use bytemuck::AnyBitPattern;
use iceoryx2::prelude::ZeroCopySend;

/// Maximum number of spans per frame and process: twenty for the frame, and six for each of
/// about 160 objects.
pub const MAX_SPANS: usize = 1024;

/// Header of a latency trace: the frame, and the process that handled it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.TraceHeader.v1")]
#[repr(C)]
pub struct TraceHeader {
    /// Process that sent the trace: code of a [`ProcessKind`](crate::ProcessKind).
    pub process: u32,
    /// Operating-system process id.
    pub pid: u32,
    /// Session number of the frame source.
    pub session: u64,
    /// Sequence number of the frame.
    pub sequence: u64,
    /// Scheduled publication time of the frame, monotonic clock, nanoseconds.
    pub scheduled_ns: u64,
    /// Flags of the frame: bits of [`frame_flag`](crate::frame_flag).
    pub frame_flags: u32,
    /// Number of spans that did not fit into this message.
    pub n_left_out: u32,
    /// Message number of the port, from 1.
    pub sent: u64,
}

const _: () = assert!(size_of::<TraceHeader>() == 48);

/// Span: one stage with its begin, end and resource use of the executing thread.
///
/// Resource use is 0 for time spent waiting.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, AnyBitPattern, ZeroCopySend)]
#[type_name("tabula.Span.v1")]
#[repr(C)]
pub struct Span {
    /// Begin of the span, monotonic clock, nanoseconds.
    pub begin_ns: u64,
    /// End of the span, monotonic clock, nanoseconds.
    pub end_ns: u64,
    /// Track-id of the object; 0 for a stage of the whole frame.
    pub track_id: u64,
    /// Processor time of the executing thread, nanoseconds.
    pub cpu_ns: u64,
    /// Heap bytes allocated by the executing thread.
    pub allocated_bytes: u64,
    /// Traced stage: code of a [`Stage`].
    pub stage: u32,
    /// Kernel thread id of the executing thread; 0 for waiting.
    pub thread_id: u32,
    /// Number of heap allocations of the thread.
    pub n_allocations: u32,
    /// Number of voluntary context switches.
    pub n_voluntary_switches: u32,
    /// Number of involuntary context switches.
    pub n_involuntary_switches: u32,
    /// Number of minor page faults (no disk access).
    pub n_minor_faults: u32,
    /// Number of major page faults (with disk access).
    pub n_major_faults: u32,
    /// Padding for alignment, zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<Span>() == 72);

impl Span {
    /// Span of waiting time, without resource use.
    pub fn waiting(stage: Stage, track_id: u64, begin_ns: u64, end_ns: u64) -> Self {
        Self {
            begin_ns,
            end_ns,
            track_id,
            stage: stage.code(),
            ..Self::default()
        }
    }

    /// Duration; 0 when the end precedes the begin.
    pub fn duration_ns(&self) -> u64 {
        self.end_ns.saturating_sub(self.begin_ns)
    }
}
