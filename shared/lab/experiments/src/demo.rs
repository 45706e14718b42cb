//! `tabula-lab demo`: demonstrations of the robot, in a daemon of their own in lockstep.
//!
//! A scripted person teaches and instructs by the daemon's public requests, and knows where the objects
//! were put; only the judge reads the truth of the simulation. After Kasaei et al. (2018), "System
//! Demonstration".

mod contact_sheet;
mod demo_stage;
mod demo_table;
mod instructor;
mod judge;
mod play;
mod recognition_score;
mod report;
mod run_record;
mod table_demo;

use crate::arguments::DemoVerb;
use command_line::Output;
use run_record::DemoKind;
use service::Failure;
use std::process::ExitCode;

/// Runs a demonstration and prints its report.
///
/// # Errors
/// When the daemon cannot be started, or a result cannot be written.
pub fn run(verb: &DemoVerb, output: &Output) -> Result<ExitCode, Failure> {
    match verb {
        DemoVerb::ClearTable(arguments) => table_demo::run(DemoKind::ClearTable, arguments, output),
        DemoVerb::Fetch(arguments) => table_demo::run(DemoKind::Fetch, arguments, output),
    }
}
