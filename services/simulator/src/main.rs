//! `tabula-simulator`: a simulated table behind the channels of camera and arm.

mod arguments;
mod arm_desk;
mod broadcast;
mod config;
mod increment;
mod run;
mod simulator_source;
mod translate;

use arguments::Arguments;
use clap::Parser;
use config::Config;
use message::ProcessKind;
use service::CountingAllocator;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    service::run(
        ProcessKind::Simulator,
        &arguments.process,
        |file| Config::new(&arguments, file),
        run::run,
    )
}
