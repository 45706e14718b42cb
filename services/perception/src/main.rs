//! `tabula-perception`: from clouds to tracked, recognised objects.

mod assumption_log;
mod bodies;
mod config;
mod control;
mod detector;
mod frame_loop;
mod intake;
mod key_view_outbox;
mod learned;
mod object_actor;
mod observation_round;
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

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    service::run(
        ProcessKind::Perception,
        &arguments.process,
        Config::new,
        run::run,
    )
}
