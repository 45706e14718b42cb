//! Transport benchmark: inter-process latency of `shared/platform/channel` compared with bare
//! iceoryx2, a Unix socket, zenoh, and the serialisation of ROS 2 without shared memory.

mod benchmark_case;
mod cdr;
mod child_report;
mod clock;
mod fragmentation;
mod iceoryx2_raw;
mod ipc_namespace;
mod latency_recorder;
mod latency_summary;
mod payload;
mod point_cloud2;
mod ports;
mod process_pair;
mod report;
mod ros_like;
mod shutdown_signal;
mod tabula_channel;
mod tokio_runtime;
mod unix_socket;
mod zenoh_shm;

use benchmark_case::{BenchmarkCase, PAYLOADS_BYTES, ReceiveMode, System};
use latency_summary::{LatencySummary, PairRun};
use report::SummaryRow;
use std::error::Error;
use std::process::ExitCode;

/// Number of interleaved rounds.
const N_ROUNDS: usize = 5;
/// Number of rounds with `--short`, whose time is mostly the start of processes.
const N_SHORT_ROUNDS: usize = 3;
/// Divisor of the number of messages with `--short`.
const SHORT_DIVISOR: u64 = 10;

/// Command-line options.
#[derive(Debug, Default, PartialEq)]
struct Options {
    /// `true` for JSON, `false` for a table.
    as_json: bool,
    /// `true` for fewer messages and rounds.
    is_short: bool,
    /// Systems to measure; all if empty.
    systems: Vec<System>,
}

impl Options {
    /// Parses the command line; `None` if invalid.
    fn parse(arguments: &[String]) -> Option<Self> {
        let mut options = Self::default();
        for argument in arguments {
            let system = System::ALL.into_iter().find(|s| s.name() == argument);
            match (argument.as_str(), system) {
                ("--json", _) => options.as_json = true,
                ("--short", _) => options.is_short = true,
                (_, Some(system)) => options.systems.push(system),
                _ => return None,
            }
        }
        Some(options)
    }

    /// Benchmark cases of the selected systems.
    fn cases(&self) -> Vec<BenchmarkCase> {
        let divisor = if self.is_short { SHORT_DIVISOR } else { 1 };
        let mut cases = Vec::new();
        for mode in ReceiveMode::ALL {
            for payload_bytes in PAYLOADS_BYTES {
                let is_selected = |s: &System| self.systems.is_empty() || self.systems.contains(s);
                let systems = System::ALL
                    .into_iter()
                    .filter(|s| s.supports(mode) && is_selected(s));
                cases.extend(systems.map(|s| BenchmarkCase::new(s, mode, payload_bytes, divisor)));
            }
        }
        cases
    }
}

/// Interleaved benchmark of all cases, so that a disturbance of the machine affects all of them
/// alike; each round starts with another case.
///
/// # Errors
/// If a child process fails, or after a termination signal.
fn measure(options: &Options) -> Result<Vec<SummaryRow>, Box<dyn Error>> {
    let cases = options.cases();
    let n_rounds = if options.is_short {
        N_SHORT_ROUNDS
    } else {
        N_ROUNDS
    };
    let mut runs: Vec<Vec<PairRun>> = vec![Vec::new(); cases.len()];
    for round in 0..n_rounds {
        for offset in 0..cases.len() {
            if shutdown_signal::is_requested() {
                return Err("interrupted".into());
            }
            let at = (round + offset) % cases.len();
            runs[at].push(process_pair::run_pair(&cases[at])?);
        }
        let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
        eprintln!(
            "round {} of {n_rounds}, load average {}",
            round + 1,
            load.trim()
        );
    }
    let row = |(case, runs): (&BenchmarkCase, &Vec<PairRun>)| SummaryRow {
        system: case.system,
        mode: case.mode,
        payload_bytes: case.payload_bytes,
        figures: LatencySummary::new(runs),
    };
    Ok(cases.iter().zip(&runs).map(row).collect())
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some((end @ (process_pair::SEND | process_pair::RECEIVE), arguments)) = arguments
        .split_first()
        .map(|(end, arguments)| (end.as_str(), arguments))
    {
        let outcome = process_pair::run_child(end, arguments);
        return outcome.map_or(ExitCode::from(2), |()| ExitCode::SUCCESS);
    }
    let Some(options) = Options::parse(&arguments) else {
        eprintln!("usage: transport [--json] [--short] [SYSTEM]...");
        return ExitCode::from(2);
    };
    shutdown_signal::watch();
    match measure(&options) {
        Ok(rows) if options.as_json => println!("{:#}", report::json(&rows)),
        Ok(rows) => print!("{}", report::table(&rows)),
        Err(error) => {
            eprintln!("transport: {error}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
