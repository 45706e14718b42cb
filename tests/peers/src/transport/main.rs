//! What it costs to bring a message from one process to another: `shared/platform/channel`
//! beside iceoryx2 alone, a Unix socket, zenoh, and what ROS 2 does without shared
//! memory.

mod answer;
mod by_zenoh;
mod cdr;
mod clock;
mod figures;
mod fragments;
mod iceoryx2_raw;
mod interruption;
mod log;
mod ours;
mod pair;
mod payload;
mod place;
mod plan;
mod point_cloud2;
mod ports;
mod reactor;
mod report;
mod ros_like;
mod unix_socket;

use figures::{Figures, Turn};
use plan::{Mode, PAYLOADS_BYTES, System, Task};
use report::Row;
use std::error::Error;
use std::process::ExitCode;

const N_TURNS: usize = 5;
/// A short run has fewer turns, too: most of it is starting processes.
const N_SHORT_TURNS: usize = 3;
const SHORT_DIVISOR: u64 = 10;

/// What the command line asks for.
#[derive(Debug, Default, PartialEq)]
struct Asked {
    as_json: bool,
    is_short: bool,
    /// All when empty.
    systems: Vec<System>,
}

impl Asked {
    fn parse(arguments: &[String]) -> Option<Self> {
        let mut asked = Self::default();
        for argument in arguments {
            let system = System::ALL.into_iter().find(|s| s.name() == argument);
            match (argument.as_str(), system) {
                ("--json", _) => asked.as_json = true,
                ("--short", _) => asked.is_short = true,
                (_, Some(system)) => asked.systems.push(system),
                _ => return None,
            }
        }
        Some(asked)
    }

    fn tasks(&self) -> Vec<Task> {
        let divisor = if self.is_short { SHORT_DIVISOR } else { 1 };
        let mut tasks = Vec::new();
        for mode in Mode::ALL {
            for payload_bytes in PAYLOADS_BYTES {
                let is_asked = |s: &System| self.systems.is_empty() || self.systems.contains(s);
                let systems = System::ALL
                    .into_iter()
                    .filter(|s| s.has(mode) && is_asked(s));
                tasks.extend(systems.map(|s| Task::new(s, mode, payload_bytes, divisor)));
            }
        }
        tasks
    }
}

/// The systems take turns, so that what disturbs the machine disturbs all; each
/// turn begins with another one.
fn measure(asked: &Asked) -> Result<Vec<Row>, Box<dyn Error>> {
    let tasks = asked.tasks();
    let n_turns = if asked.is_short {
        N_SHORT_TURNS
    } else {
        N_TURNS
    };
    let mut turns: Vec<Vec<Turn>> = vec![Vec::new(); tasks.len()];
    for turn in 0..n_turns {
        for offset in 0..tasks.len() {
            if interruption::is_asked() {
                return Err("interrupted".into());
            }
            let at = (turn + offset) % tasks.len();
            turns[at].push(pair::take_turn(&tasks[at])?);
        }
        let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
        eprintln!(
            "turn {} of {n_turns}, load average {}",
            turn + 1,
            load.trim()
        );
    }
    let row = |(task, turns): (&Task, &Vec<Turn>)| Row {
        system: task.system,
        mode: task.mode,
        payload_bytes: task.payload_bytes,
        figures: Figures::new(turns),
    };
    Ok(tasks.iter().zip(&turns).map(row).collect())
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some((end @ (pair::SEND | pair::RECEIVE), words)) = arguments
        .split_first()
        .map(|(end, words)| (end.as_str(), words))
    {
        let lived = pair::live_as_child(end, words);
        return lived.map_or(ExitCode::from(2), |()| ExitCode::SUCCESS);
    }
    let Some(asked) = Asked::parse(&arguments) else {
        eprintln!("usage: transport [--json] [--short] [SYSTEM]...");
        return ExitCode::from(2);
    };
    interruption::watch();
    match measure(&asked) {
        Ok(rows) if asked.as_json => println!("{:#}", report::json(&rows)),
        Ok(rows) => print!("{}", report::table(&rows)),
        Err(error) => {
            eprintln!("transport: {error}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
