//! `tabula-lab demo`: demonstrations of the robot, in a daemon of their own in lockstep.
//!
//! A scripted person teaches and instructs by the daemon's public requests, and knows where the objects
//! were put; only the judge reads the truth of the simulation. After Kasaei et al. (2018), "System
//! Demonstration".

mod clear_table;
mod contact_sheet;
mod demo_stage;
mod demo_table;
mod instructor;
mod judge;
mod play;
mod recognition_score;
mod report;
mod run_record;

use crate::arguments::DemoVerb;
use command_line::Output;
use service::Failure;
use std::process::ExitCode;

/// Runs a demonstration and prints its report.
///
/// # Errors
/// When the daemon cannot be started, or a result cannot be written.
pub fn run(verb: &DemoVerb, output: &Output) -> Result<ExitCode, Failure> {
    match verb {
        DemoVerb::ClearTable(arguments) => clear_table::run(arguments, output),
    }
}
