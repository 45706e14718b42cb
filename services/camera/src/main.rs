//! `tabula-camera`: publisher of one sensor's point clouds.

use camera::{CameraArguments, Config, ReplayRequest};
use message::ProcessKind;
use service::{ConfigFile, CountingAllocator};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

fn main() -> ExitCode {
    let arguments: CameraArguments = service::parse_arguments();
    let check_only = arguments.process.check_config;
    let check = |file: &ConfigFile| {
        let config = Config::new(&arguments, file)?;
        if check_only {
            camera::check_source(&config)?;
        } else {
            camera::restart_with_recording(&config)?;
        }
        Ok(config)
    };
    let again = ReplayRequest::default();
    let run = |context, config| camera::run(context, config, again.clone());
    again.or(service::run(
        ProcessKind::Camera,
        &arguments.process,
        check,
        run,
    ))
}
