//! `tabula-modeller`: builds the full model of an object from the views of a moving camera, and
//! plans the next best view, grasps and transports, beside a running daemon and at low priority.

mod arguments;
mod arm_scene;
mod awaited_snapshot;
mod build;
mod camera_motion;
mod grasp;
mod growth;
mod handling;
mod model_document;
mod next_move;
mod object_receiver;
mod obstacle;
mod place;
mod plan;
mod png_file;
mod presence;
mod transit_document;
mod view_queue;

use arguments::{ModellerArguments, ModellerVerb};
use command_line::Output;
use service::{Failure, OptionUse, set_private_umask};
use std::process::ExitCode;

/// Nice value: below the daemon, but a robot waits for a plan, and a camera does not wait for a
/// model.
const NICENESS: u8 = 10;

fn main() -> ExitCode {
    let arguments: ModellerArguments = service::parse_arguments();
    let output = Output::new(arguments.json);
    set_private_umask();
    output.exit_code(execute(&arguments, &output))
}

fn execute(arguments: &ModellerArguments, output: &Output) -> Result<ExitCode, Failure> {
    let used = match &arguments.verb {
        ModellerVerb::Build(_) | ModellerVerb::Plan(_) => OptionUse::Daemon,
        // The gripper and the places stand in the configuration.
        ModellerVerb::Grasp(_) | ModellerVerb::Place(_) | ModellerVerb::Places => {
            OptionUse::Everything
        }
    };
    arguments.common.check_use(used)?;
    let niceness = match &arguments.verb {
        ModellerVerb::Build(build) => build.niceness.min(NICENESS),
        ModellerVerb::Plan(_)
        | ModellerVerb::Grasp(_)
        | ModellerVerb::Place(_)
        | ModellerVerb::Places => NICENESS,
    };
    rustix::process::nice(niceness.into())
        .map_err(|error| Failure::general(format!("the priority could not be lowered: {error}")))?;
    match &arguments.verb {
        ModellerVerb::Build(build) => build::run(&arguments.common, build, output),
        ModellerVerb::Plan(plan) => plan::run(&arguments.common, plan, output),
        ModellerVerb::Grasp(grasp) => grasp::run(&arguments.common, grasp, output),
        ModellerVerb::Place(place) => place::run(&arguments.common, place, output),
        ModellerVerb::Places => place::run_list(&arguments.common, output),
    }
}
