//! Actor benchmark: `shared/platform/actor` compared with bare tokio tasks, ractor and kameo.

mod adder_group;
mod counting_allocator;
mod kameo_adders;
mod lifecycle;
mod ractor_adders;
mod report;
mod tabula_adders;
mod tokio_adders;

use adder_group::AdderGroup;
use kameo_adders::KameoAdders;
use lifecycle::{LifecycleCosts, measure_lifecycle, median};
use ractor_adders::RactorAdders;
use report::Row;
use std::process::ExitCode;
use tabula_adders::TabulaAdders;
use tokio_adders::TokioAdders;

#[global_allocator]
static ALLOCATOR: counting_allocator::CountingAllocator = counting_allocator::CountingAllocator;

/// Default group sizes, in actors.
const SIZES: [usize; 5] = [1, 10, 100, 1_000, 10_000];

/// Number of actors spawned in total per group size, in consecutive groups. Chosen.
const N_ACTORS: usize = 100_000;
/// Least and greatest number of groups per size. Chosen: enough for a median.
const N_GROUPS_RANGE: [usize; 2] = [15, 2_000];

/// Name of an actor system and its benchmark.
type System = (&'static str, fn(usize) -> LifecycleCosts);

/// Actor systems under test; the first is the baseline of the ratios.
const SYSTEMS: [System; 4] = [
    (TokioAdders::NAME, measure_lifecycle::<TokioAdders>),
    (TabulaAdders::NAME, measure_lifecycle::<TabulaAdders>),
    (RactorAdders::NAME, measure_lifecycle::<RactorAdders>),
    (KameoAdders::NAME, measure_lifecycle::<KameoAdders>),
];

/// Interleaved benchmark of all systems at one size, so that a disturbance of the machine affects
/// all of them alike.
fn measure(n: usize) -> Vec<Row> {
    let n_groups = (N_ACTORS / n).clamp(N_GROUPS_RANGE[0], N_GROUPS_RANGE[1]);
    let mut costs = SYSTEMS.map(|_| Vec::with_capacity(n_groups));
    for _ in 0..n_groups {
        for ((_, measure), costs) in SYSTEMS.iter().zip(&mut costs) {
            costs.push(measure(n));
        }
    }
    let rows = SYSTEMS.iter().zip(&costs);
    rows.map(|((system, _), costs)| Row {
        system,
        n,
        costs: median(costs),
    })
    .collect()
}

/// Parses the command line: `--json` or a table, and the group sizes. `None` if invalid.
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
