//! `tabula-gateway`: serves the control socket, and passes each request to its owner.
//!
//! It has no store, and opens no file on a disk while it serves, but to reload its configuration: a
//! process that is dead, stopped or hung costs only the requests that it owns.

mod arm_clients;
mod config;
mod history_position;
mod process_table;
mod request_router;
mod run;
mod urgent_commands;

use clap::Parser;
use config::Config;
use message::ProcessKind;
use service::{CountingAllocator, ProcessArguments};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Serves people and programs on the control socket, and passes each request to its owner.
#[derive(Debug, Parser)]
#[command(name = "tabula-gateway", version)]
struct GatewayArguments {
    #[command(flatten)]
    process: ProcessArguments,
}

fn main() -> ExitCode {
    let arguments: GatewayArguments = service::parse_arguments();
    service::run(
        ProcessKind::GATEWAY,
        &arguments.process,
        |found, _| Config::new(found),
        run::run,
    )
}
