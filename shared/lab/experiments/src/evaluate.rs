//! `tabula evaluate`: how good and how fast the kernels are.

mod ablation;
mod cross_validation;
mod csv;
mod detection;
mod document;
mod object_views;
mod open_ended;
mod open_set;
pub(crate) mod parallel;
mod report;
mod scene_views;
mod stopwatch;
mod tracking;
mod variant;
mod whole_file;

use crate::arguments::EvaluateVerb;
use command_line::Output;
use service::{Failure, exit_code};
use std::process::ExitCode;

/// Carries out a verb of `tabula evaluate`.
pub fn run(verb: &EvaluateVerb, output: &Output) -> Result<ExitCode, Failure> {
    match verb {
        EvaluateVerb::Detection(arguments) => detection::run(arguments, output),
        EvaluateVerb::Tracking(arguments) => tracking::run(arguments, output),
        EvaluateVerb::OpenEnded(arguments) => open_ended::run(arguments, output),
        EvaluateVerb::Ablation(arguments) => ablation::run(arguments, output),
        EvaluateVerb::CrossValidation(arguments) => cross_validation::run(arguments, output),
    }
}

fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::new(exit_code::FAILURE, error)
}
