//! `tabula-latency`: end-to-end latency measurement of the daemon.

mod arguments;
mod compare;
mod conditions;
mod daemon_under_test;
mod machine_report;
mod measure;
mod measured_daemon;
mod merge;
mod pcl_peer;
mod process_usage;
mod report_text;
mod results;
mod soak;
mod stop;
mod sweep;
mod sweep_axis;
mod trace_reader;
mod transport_peers;

use arguments::{LatencyArguments, LatencyCommand};
use command_line::Output;
use service::Failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = LatencyArguments::checked();
    let output = Output::new(arguments.as_ref().is_ok_and(|given| given.json));
    output.exit_code(arguments.and_then(|arguments| execute(&arguments, &output)))
}

fn execute(arguments: &LatencyArguments, output: &Output) -> Result<ExitCode, Failure> {
    arguments.common.check_use(arguments.option_use())?;
    match &arguments.command {
        None => measure::run(&arguments.common, &arguments.measure, output),
        Some(LatencyCommand::Machine { short, out }) => {
            machine_report::run(*short, out.as_deref(), output)
        }
        Some(LatencyCommand::Peers { short, pcl, scenes }) => match pcl {
            Some(harness) => pcl_peer::run(harness, scenes, *short, output),
            None => transport_peers::run(*short, output),
        },
        Some(LatencyCommand::Soak(soak)) => soak::run(&arguments.common, soak, output),
        Some(LatencyCommand::Stop(stop)) => stop::run(stop, output),
        Some(LatencyCommand::Sweep(sweep)) => sweep::run(&arguments.common, sweep, output),
        Some(LatencyCommand::Compare { before, now }) => compare::run(before, now, output),
        Some(LatencyCommand::Merge { files, out }) => merge::run(files, out.as_deref(), output),
    }
}
