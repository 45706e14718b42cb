//! `tabula-simulator`: a simulated table with camera, arm and person.

mod arguments;
mod arm_loop;
mod arm_orders;
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
    let process = arguments.process.clone();
    service::run(
        ProcessKind::SIMULATOR,
        &process,
        move |found, _| Config::new(&arguments, found),
        // Its keys need a restart.
        |context, config| run::run(context, config.get().as_ref().clone()),
    )
}
