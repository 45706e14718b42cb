//! `tabula-modeller`: builds the full model of an object from the views of a moving camera, and
//! plans the next best view, beside a running daemon and at low priority.

mod arguments;
mod build;
mod frame_headers;
mod growth;
mod hypotheses;
mod model_document;
mod object_receiver;
mod plan;
mod presence;

use arguments::{ModellerArguments, ModellerVerb};
use command_line::Output;
use service::{Failure, set_private_umask};
use std::process::ExitCode;

/// Increment of the nice value for models: the lowest priority, since the frames of the daemon go
/// before.
const MODEL_NICENESS: i32 = 19;
/// Increment for plans: below the daemon, too, but a robot waits for the answer.
const PLAN_NICENESS: i32 = 10;

fn main() -> ExitCode {
    let arguments: ModellerArguments = service::parse_arguments();
    let output = Output::new(arguments.json);
    set_private_umask();
    output.exit_code(execute(&arguments, &output))
}

fn execute(arguments: &ModellerArguments, output: &Output) -> Result<ExitCode, Failure> {
    let niceness = match &arguments.verb {
        ModellerVerb::Build(_) => MODEL_NICENESS,
        ModellerVerb::Plan(_) => PLAN_NICENESS,
    };
    rustix::process::nice(niceness)
        .map_err(|error| Failure::general(format!("the priority could not be lowered: {error}")))?;
    match &arguments.verb {
        ModellerVerb::Build(build) => build::run(&arguments.common, build, output),
        ModellerVerb::Plan(plan) => plan::run(&arguments.common, plan, output),
    }
}
