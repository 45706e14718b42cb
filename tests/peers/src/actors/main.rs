//! What an actor costs beside a bare task, ractor and kameo, in one run.

mod allocation;
mod bare;
mod by_kameo;
mod by_ractor;
mod crew;
mod measurement;
mod ours;
mod report;

use bare::Bare;
use by_kameo::ByKameo;
use by_ractor::ByRactor;
use crew::Crew;
use measurement::{Life, live, median};
use ours::Ours;
use report::Row;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: allocation::Counting = allocation::Counting;

/// Unless the command line says otherwise.
const SIZES: [usize; 5] = [1, 10, 100, 1_000, 10_000];

/// Actors that live in a measurement of one size, one crew after the other.
const N_ACTORS: usize = 100_000;
/// So few crews are enough, and so many, for a median.
const N_CREWS: [usize; 2] = [15, 2_000];

type System = (&'static str, fn(usize) -> Life);

const SYSTEMS: [System; 4] = [
    (Bare::NAME, live::<Bare>),
    (Ours::NAME, live::<Ours>),
    (ByRactor::NAME, live::<ByRactor>),
    (ByKameo::NAME, live::<ByKameo>),
];

/// The systems take turns, so that what disturbs the machine disturbs all.
fn measure(n: usize) -> Vec<Row> {
    let n_crews = (N_ACTORS / n).clamp(N_CREWS[0], N_CREWS[1]);
    let mut lives = SYSTEMS.map(|_| Vec::with_capacity(n_crews));
    for _ in 0..n_crews {
        for ((_, live), lives) in SYSTEMS.iter().zip(&mut lives) {
            lives.push(live(n));
        }
    }
    let rows = SYSTEMS.iter().zip(&lives);
    rows.map(|((system, _), lives)| Row {
        system,
        n,
        life: median(lives),
    })
    .collect()
}

/// What the command line asks for: JSON or a table, of which sizes.
fn parse(arguments: impl Iterator<Item = String>) -> Option<(bool, Vec<usize>)> {
    let (mut as_json, mut sizes) = (false, Vec::new());
    for argument in arguments {
        match (argument.as_str(), argument.parse()) {
            ("--json", _) => as_json = true,
            (_, Ok(n)) if n > 0 => sizes.push(n),
            _ => return None,
        }
    }
    if sizes.is_empty() {
        sizes.extend(SIZES);
    }
    Some((as_json, sizes))
}

fn main() -> ExitCode {
    let Some((as_json, sizes)) = parse(std::env::args().skip(1)) else {
        eprintln!("usage: actors [--json] [NUMBER OF ACTORS]...");
        return ExitCode::from(2);
    };
    let rows: Vec<Row> = sizes.into_iter().flat_map(measure).collect();
    if as_json {
        println!("{}", report::json(&rows));
    } else {
        print!("{}", report::table(&rows));
    }
    ExitCode::SUCCESS
}
