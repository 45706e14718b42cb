//! What every process shares: arguments, configuration, tracing, signals,
//! readiness, watchdog, health.
//!
//! A process is `main.rs` (parse the arguments, call [`run`]) and a function
//! that is given a [`Context`] and returns when `context.shutdown` asks it to.
//! Each process has one owner of its signals, its log and its readiness: this
//! crate. It knows nothing of perception, learning or cameras.

mod allocation_count;
mod arguments;
mod clock;
mod config_file;
mod context;
mod cores;
mod exit;
mod health_board;
mod health_report;
mod home;
mod log;
mod run;
mod shutdown;
mod stopwatch;
mod thread_usage;
mod trace_publisher;

pub use allocation_count::CountingAllocator;
pub use arguments::{CommonArguments, ProcessArguments};
pub use clock::{monotonic_ns, wall_clock_ns, wall_clock_offset_ns};
pub use config_file::{ConfigError, ConfigFile};
pub use context::Context;
pub use cores::Cores;
pub use exit::{Failure, exit_code};
pub use health_board::HealthBoard;
pub use home::Home;
pub use run::{follow_parent, run};
pub use shutdown::Shutdown;
pub use stopwatch::Stopwatch;
pub use thread_usage::{ThreadUsage, thread_id};
pub use trace_publisher::TracePublisher;
