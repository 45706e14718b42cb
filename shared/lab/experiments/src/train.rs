//! `tabula-lab train`: models that are trained on simulated scenes.

mod region_merging;

use crate::arguments::TrainVerb;
use command_line::Output;
use service::Failure;
use std::process::ExitCode;

/// Runs a subcommand of `tabula-lab train`.
///
/// # Errors
/// When a data set cannot be read or has no examples, or a file cannot be written.
pub fn run(verb: &TrainVerb, output: &Output) -> Result<ExitCode, Failure> {
    match verb {
        TrainVerb::RegionMerging(arguments) => region_merging::run(arguments, output),
    }
}
