//! `tabula-latency`: end-to-end latency measurement of the daemon.

mod arguments;
mod chosen_daemon;
mod compare;
mod conditions;
mod listener;
mod machine_report;
mod measure;
mod merge;
mod own_daemon;
mod pcl;
mod peers;
mod process_usage;
mod report_text;
mod results;
mod soak;
mod sweep;

use arguments::{Arguments, Verb};
use command_line::Output;
use service::Failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::checked();
    let output = Output::new(arguments.as_ref().is_ok_and(|given| given.json));
    let outcome = arguments.and_then(|arguments| execute(&arguments, &output));
    outcome.unwrap_or_else(|failure| {
        output.failure(&failure);
        ExitCode::from(failure.code)
    })
}

fn execute(arguments: &Arguments, output: &Output) -> Result<ExitCode, Failure> {
    match &arguments.verb {
        None => measure::run(&arguments.common, &arguments.measure, output),
        Some(Verb::Machine { short, out }) => machine_report::run(*short, out.as_deref(), output),
        Some(Verb::Peers { short, pcl, scenes }) => match pcl {
            Some(harness) => pcl::run(harness, scenes, *short, *output),
            None => peers::run(*short, output),
        },
        Some(Verb::Soak(soak)) => soak::run(&arguments.common, soak, output),
        Some(Verb::Sweep(sweep)) => sweep::run(&arguments.common, sweep, output),
        Some(Verb::Compare { before, now }) => compare::run(before, now, output),
        Some(Verb::Merge { files, out }) => merge::run(files, out.as_deref(), output),
    }
}
