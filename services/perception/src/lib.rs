//! `tabula-perception`: object detection, tracking and recognition in organised point
//! clouds.
//!
//! The library serves two programs: that of the daemon, and, with the feature
//! `fault-injection`, one for tests of the supervision.

mod actor_event_publisher;
mod arrival_intervals;
mod assumption_log;
mod body_subscriber;
mod camera_watch;
mod config;
mod control;
mod detector;
#[cfg(feature = "fault-injection")]
mod fault_injection;
mod frame_loop;
mod frame_receiver;
mod frame_trace;
mod helper_threads;
mod latest_scene;
mod live_executor;
mod liveness_probe;
mod log_once;
mod memory_replica;
mod newest_view;
mod noise_log;
mod novelty_prior_file;
mod object_actor;
mod object_actors;
mod outbox;
mod publishers;
mod redescription;
mod restart_backoff;
mod run;
mod scene_priors;
mod scene_report;
mod table_log;
mod track_ids;

use clap::Parser;
use config::Config;
use message::ProcessKind;
use service::{CountingAllocator, ProcessArguments};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Detects, tracks and recognises the objects in the camera's clouds.
#[derive(Debug, Parser)]
#[command(name = "tabula-perception", version)]
struct PerceptionArguments {
    #[command(flatten)]
    process: ProcessArguments,
}

/// Entry point: runs the service with the command-line arguments.
pub fn main() -> ExitCode {
    let arguments: PerceptionArguments = service::parse_arguments();
    service::run(
        ProcessKind::PERCEPTION,
        &arguments.process,
        |found, _| Config::new(found),
        run::run,
    )
}
