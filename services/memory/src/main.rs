//! `tabula-memory`: perceptual and working memory.

mod change_publisher;
mod config;
mod configuration_change;
mod daily_purge;
mod event_report;
mod find_request;
mod health_conditions;
mod offline;
mod question_asker;
mod request_router;
mod run;
mod scene_follower;
mod task_report;
mod working_memory;
mod working_memory_requests;
mod world_model_updater;
mod world_report;

use clap::Parser;
use config::Config;
use message::ProcessKind;
use service::{CountingAllocator, ProcessArguments};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Stores views, labels and the world model, and answers the requests about them.
#[derive(Debug, Parser)]
#[command(name = "tabula-memory", version)]
struct MemoryArguments {
    #[command(flatten)]
    process: ProcessArguments,

    /// Serve requests about the stored memory on standard input without a daemon; used by `tabula
    /// memory` when no daemon runs
    #[arg(long)]
    offline: bool,
}

fn main() -> ExitCode {
    let arguments: MemoryArguments = service::parse_arguments();
    if arguments.offline {
        service::set_private_umask();
        return offline(&arguments.process);
    }
    service::run(
        ProcessKind::MEMORY,
        &arguments.process,
        |found, _| Config::new(found),
        run::run,
    )
}

#[expect(clippy::print_stderr, reason = "without a daemon there is no log")]
fn offline(arguments: &ProcessArguments) -> ExitCode {
    match offline::run(&arguments.common) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("tabula-memory: {failure}");
            ExitCode::from(failure.code)
        }
    }
}
