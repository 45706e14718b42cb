//! `tabula-executive`: carries out tasks with the arm, such as clearing the table.
//!
//! It reaches the rest of the daemon by its public requests and topics only, as any program can. The
//! plan of a task is a record of the working memory, from which another process goes on after a
//! death of this one.

mod config;
mod executor;
mod robot;
mod run;
mod task_requests;
mod task_run;

use clap::Parser;
use config::Config;
use message::ProcessKind;
use service::{CountingAllocator, ProcessArguments};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Carries out the tasks of the robot.
#[derive(Debug, Parser)]
#[command(name = "tabula-executive", version)]
struct ExecutiveArguments {
    #[command(flatten)]
    process: ProcessArguments,
}

fn main() -> ExitCode {
    let arguments: ExecutiveArguments = service::parse_arguments();
    let common = arguments.process.common.clone();
    service::run(
        ProcessKind::EXECUTIVE,
        &arguments.process,
        |found, _| Config::new(found),
        |context, live| run::run(context, live, common),
    )
}
