//! `tabula-camera`: publisher of one sensor's point clouds.

use camera::{CameraArguments, Config, ReplayRequest};
use message::ProcessKind;
use service::{Configuration, CountingAllocator, LiveConfig, Purpose};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

fn main() -> ExitCode {
    let arguments: CameraArguments = service::parse_arguments();
    let process = arguments.process.clone();
    let check = move |found: &Configuration, purpose: Purpose| {
        let config = Config::new(&arguments, found)?;
        match purpose {
            Purpose::Check => {
                let places = service::guest_places(found)?;
                camera::check_source(&config, &arguments.process.common.domain, places)?;
            }
            Purpose::Start => camera::restart_with_recording(&config)?,
            Purpose::Reload => {}
        }
        Ok(config)
    };
    let again = ReplayRequest::default();
    let run = |context, config: LiveConfig<Config>| {
        // Its keys need a restart.
        let config = config.get().as_ref().clone();
        camera::run(context, config, again.clone())
    };
    again.or(service::run(ProcessKind::CAMERA, &process, check, run))
}
