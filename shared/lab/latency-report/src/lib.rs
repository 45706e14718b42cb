//! Where the milliseconds go: from the spans that the processes tell of each frame to
//! percentiles, worst frames, comparisons and pictures.
//!
//! Time is counted from the *scheduled* capture, in an open loop: a frame that was
//! late counts as long as it was late, and one that never came counts until the next
//! one did (Tene, "How NOT to measure latency", 2013, calls the contrary coordinated
//! omission).
//!
//! This crate reads no clock, no file and no shared memory: messages in, figures and
//! text of files out.

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
