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
//!         process: ProcessKind::Perception.code(),
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

mod batches;
mod budget;
mod comparison;
mod figures;
mod gathering;
mod histogram_file;
mod measurement;
mod open_loop;
mod percentiles;
mod report;
mod soak;
mod sum_check;
mod sweep;
mod timeline;
mod usage;
mod way;
mod worst;

pub use batches::Batch;
pub use budget::{Budget, Excess, InvalidBudget};
pub use comparison::{Comparison, Verdict, compare};
pub use figures::{percentile_figure, time_figure};
pub use gathering::Gathering;
pub use histogram_file::{HistogramFileError, Histograms};
pub use measurement::Measurement;
pub use open_loop::OpenLoop;
pub use percentiles::{NamedPercentile, Percentiles};
pub use report::{
    Conditions, Measuring, Objects, ProcessReport, Report, SharedMemoryReport, StageReport,
};
pub use soak::{Growth, SoakWindow, growths, soak_figure};
pub use sum_check::SumCheck;
pub use sweep::{SweepRow, sweep_figure};
pub use timeline::timeline;
pub use usage::Usage;
pub use way::{FrameWay, Passage};
pub use worst::WorstFrame;
