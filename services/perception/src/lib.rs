//! `tabula-perception`: from clouds to tracked, recognised objects.
//!
//! A library for two programs: the daemon's own, and, with the feature
//! `fault-injection`, one for tests whose actors panic when they are told to.

mod actor_events;
mod assumption_log;
mod bodies;
mod config;
mod control;
mod detector;
#[cfg(feature = "fault-injection")]
mod fault;
mod frame_loop;
mod frame_trace;
mod helpers;
mod intake;
mod key_view_outbox;
mod learned;
mod newest_view;
mod object_actor;
mod observation_round;
mod ports;
mod resting;
mod run;
mod scene_report;
mod table_log;
mod track_ids;
mod world;

use clap::Parser;
use config::Config;
use message::ProcessKind;
use service::{CountingAllocator, ProcessArguments};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Finds the objects in the camera's clouds, follows and recognises them.
#[derive(Debug, Parser)]
#[command(name = "tabula-perception", version)]
struct Arguments {
    #[command(flatten)]
    process: ProcessArguments,
}

/// Runs the process with the arguments it was given.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    service::run(
        ProcessKind::Perception,
        &arguments.process,
        Config::new,
        run::run,
    )
}
