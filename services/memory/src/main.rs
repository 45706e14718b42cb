//! `tabula-memory`: keeps what was taught, and answers people.

mod announcer;
mod answer;
mod config;
mod control;
mod event_report;
mod process_table;
mod run;
mod scene_follower;
mod upkeep;
mod world;
mod world_answer;
mod world_feed;
mod world_report;

use clap::Parser;
use config::Config;
use message::ProcessKind;
use service::{CountingAllocator, ProcessArguments};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Keeps what was taught, and answers people and the daemon's other processes.
#[derive(Debug, Parser)]
#[command(name = "tabula-memory", version)]
struct Arguments {
    #[command(flatten)]
    process: ProcessArguments,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    service::run(
        ProcessKind::Memory,
        &arguments.process,
        Config::new,
        run::run,
    )
}
