//! Process runtime of the daemon: arguments, configuration, log, signals, readiness,
//! watchdog, health.
//!
//! A process is `main.rs` (parse the arguments, call [`run`]) and a function that
//! gets a [`Context`] and returns when `context.shutdown` is requested. Its
//! long-running tasks form a [`TaskGroup`]. Each process has one owner of its
//! signals, its log and its readiness: this crate. It knows nothing of perception,
//! learning or cameras.
//!
//! ```
//! use service::TaskGroup;
//!
//! # tokio::runtime::Builder::new_current_thread().enable_time().build().unwrap().block_on(async {
//! let mut tasks = TaskGroup::default();
//! tasks.spawn("the server", std::future::pending());
//! tasks.spawn("the publisher", async {});
//! let failure = tasks.run(std::future::pending()).await.unwrap_err();
//! assert_eq!(failure.sentence, "the publisher has ended unexpectedly");
//! # });
//! ```

mod arguments;
mod clock;
mod configuration;
mod context;
mod controlling_terminal;
mod cpu_affinity;
mod failure;
mod guest_places;
mod health_counters;
mod health_reporter;
mod home;
mod log;
mod manuals;
mod option_use;
mod processor;
mod program_arguments;
mod real_time;
mod reload;
mod run;
mod service_manager;
mod shutdown;
mod stopwatch;
mod task_group;
mod thread_usage;
mod trace_publisher;

pub use allocation_counter::CountingAllocator;
pub use arguments::{CommonArguments, ProcessArguments};
pub use clock::{monotonic_ns, wall_clock_ns, wall_clock_offset_ns};
pub use configuration::{
    ConfigError, Configuration, KeyBound, KeyDescription, KeyRange, KeyReference, SECTIONS,
    Setting, ValueKind, check_section_reference, nearest_names, probable_name,
};
pub use context::Context;
pub use controlling_terminal::ControllingTerminal;
pub use cpu_affinity::CpuAffinity;
pub use failure::{Failure, exit_code};
pub use guest_places::guest_places;
pub use health_counters::HealthCounters;
pub use home::{Home, set_private_umask};
pub use log::start_log;
pub use option_use::{GivenOptions, OptionUse};
pub use program_arguments::parse_arguments;
pub use real_time::set_real_time_priority;
pub use reload::{
    LiveConfig, ReloadPlan, ReloadRecordPublisher, last_reloads, log_reload, reload_processes,
};
pub use run::{Purpose, run, stop_with_parent};
pub use service_manager::{ReloadNotice, is_service};
pub use shutdown::{Shutdown, ShutdownTrigger};
pub use stopwatch::Stopwatch;
pub use task_group::TaskGroup;
pub use thread_usage::{ThreadUsage, thread_id};
pub use trace_publisher::TracePublisher;
