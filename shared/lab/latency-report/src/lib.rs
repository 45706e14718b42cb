//! End-to-end latency analysis: from trace spans of each frame to percentiles, worst frames,
//! comparisons and figures.
//!
//! Latency is measured from the *scheduled* capture (open loop): a late frame counts its delay,
//! and a frame that never came counts until the labels of the next one. This corrects coordinated
//! omission (Tene, "How NOT to measure latency", 2013).
//!
//! ```
//! use latency_report::{Conditions, FrameAssembler, LatencyRecorder, LatencyReport,
//! MeasurementOverhead};
//! use message::{ProcessKind, Span, Stage, TraceHeader};
//!
//! let mut assembler = FrameAssembler::default();
//! for sequence in 0..3 {
//!     let scheduled_ns = sequence * 33_000_000;
//!     let header = TraceHeader {
//!         process: ProcessKind::PERCEPTION.code(),
//!         session: 1,
//!         sequence,
//!         scheduled_ns,
//!         ..TraceHeader::default()
//!     };
//!     let end_ns = scheduled_ns + 10_000_000;
//!     let published = Span::waiting(Stage::Publishing, 0, scheduled_ns, end_ns);
//!     assembler.add(&header, &[published]);
//! }
//! let mut recorder = LatencyRecorder::new(0);
//! assembler.drain().for_each(|frame| recorder.add(frame));
//!
//! let overhead = MeasurementOverhead::default();
//! let report = LatencyReport::new(&recorder, &overhead, Conditions::default());
//! assert_eq!(report.end_to_end_ms.p50, 10.0);
//! ```
//!
//! Invariants: this crate reads no clock, no file and no shared memory; messages in, figures and
//! file contents out.

mod batch_means;
mod budget;
mod comparison;
mod coordinated_omission;
mod duration_percentiles;
mod frame_assembler;
mod frame_timeline;
mod histogram_file;
mod latency_figures;
mod latency_recorder;
mod report;
mod resource_usage;
mod slowest_frames;
mod soak;
mod sum_check;
mod sweep;
mod trace_event;

pub use batch_means::Batch;
pub use budget::{Budget, BudgetViolation, InvalidBudget};
pub use comparison::{Comparison, ComparisonVerdict, compare};
pub use coordinated_omission::MissedFrames;
pub use duration_percentiles::{DurationPercentiles, NamedPercentile};
pub use frame_assembler::FrameAssembler;
pub use frame_timeline::{FrameTimeline, StageInterval};
pub use histogram_file::{HistogramFileError, Histograms};
pub use latency_figures::{percentile_figure, time_figure};
pub use latency_recorder::LatencyRecorder;
pub use report::{
    Conditions, LatencyReport, MeasurementOverhead, ObjectCounts, ProcessReport,
    SharedMemoryReport, StageReport,
};
pub use resource_usage::ResourceUsage;
pub use slowest_frames::WorstFrame;
pub use soak::{Growth, SoakWindow, find_growth, soak_figure};
pub use sum_check::SumCheck;
pub use sweep::{SweepRow, sweep_figure};
pub use trace_event::chrome_trace;
