//! `tabula evaluate`: how good and how fast the kernels are.

mod detection;
mod document;
mod report;
mod stopwatch;
mod tracking;
mod whole_file;

use crate::arguments::EvaluateVerb;
use crate::output::Output;
use service::{Failure, exit_code};
use std::process::ExitCode;

/// Carries out a verb of `tabula evaluate`.
pub(crate) fn run(verb: &EvaluateVerb, output: &Output) -> Result<ExitCode, Failure> {
    match verb {
        EvaluateVerb::Detection(arguments) => detection::run(arguments, output),
        EvaluateVerb::Tracking(arguments) => tracking::run(arguments, output),
    }
}

fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::new(exit_code::FAILURE, error)
}
