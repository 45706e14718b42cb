//! What the programs for people share: answers as text or JSON, tables, bars that
//! show progress, and being asked to stop.
//!
//! A program prints through one [`Output`] only: answers on standard output, what
//! happens meanwhile where it disturbs no script.

mod output;
mod progress;
mod stop_signal;
mod table;

pub use output::{Output, redraw};
pub use progress::bar;
pub use stop_signal::StopSignal;
pub use table::table;
