//! `tabula-simulator`: a simulated table with camera, arm and person.

mod arguments;
mod arm_command_queue;
mod config;
mod frame_interval;
mod run;
mod simulator_source;
mod wire_conversion;
mod world_publishers;

use arguments::SimulatorArguments;
use config::Config;
use message::ProcessKind;
use service::CountingAllocator;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

fn main() -> ExitCode {
    let arguments: SimulatorArguments = service::parse_arguments();
    service::run(
        ProcessKind::Simulator,
        &arguments.process,
        |file| Config::new(&arguments, file),
        run::run,
    )
}
