//! What a teaching costs beside C++ LevelDB, which writes the same bytes, and what
//! it costs to load all that was taught.

mod cpp;
mod disk;
mod figures;
mod ours;
mod plan;
mod report;
mod trace;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use cpp::Cpp;
use figures::{Load, Run, median, quantile};
use plan::{Plan, Scenario};
use report::{Disk, Row};

const N_TURNS: usize = 5;
/// Bare syncs timed at first, and before each run.
const N_SYNCS: usize = 500;
const N_SYNCS_PER_RUN: usize = 20;
const N_LOADS: usize = 5;
const N_LOADED_VIEWS: usize = 100_000;
/// Clouds that come with the views that are loaded.
const CLOUDS_BYTES: [usize; 2] = [0, 5_000];
/// Of all counts, in the turn that only warms up and in a short run.
const SHARE_OF_WARM_UP: f64 = 0.1;
const SHARE_OF_SHORT_RUN: f64 = 0.1;

/// What the command line asks for.
struct Asked {
    as_json: bool,
    is_short: bool,
    /// Where to make the databases.
    folder: PathBuf,
}

/// Times all scenarios on new databases.
fn take_turn(
    folder: &Path,
    cpp: &Cpp,
    plan: &Plan,
    scenarios: &[Scenario],
    is_ours_first: bool,
) -> io::Result<Vec<[Option<Run>; 2]>> {
    let [of_ours, of_cpp] = ["ours", "cpp"].map(|name| folder.join(name));
    ours::prefill(&of_ours, plan);
    cpp.prefill(&of_cpp, plan);
    let mut runs = Vec::with_capacity(scenarios.len());
    for scenario in scenarios {
        let run_ours = || timed(folder, || ours::run(&of_ours, plan, scenario));
        let run_cpp = || timed(folder, || Some(cpp.run(&of_cpp, scenario)));
        runs.push(if is_ours_first {
            [run_ours()?, run_cpp()?]
        } else {
            let of_cpp = run_cpp()?;
            [run_ours()?, of_cpp]
        });
    }
    fs::remove_dir_all(of_ours)?;
    fs::remove_dir_all(of_cpp)?;
    Ok(runs)
}

/// A run, and what a bare sync takes just before: disks have good and bad times.
fn timed(folder: &Path, run: impl FnOnce() -> Option<Run>) -> io::Result<Option<Run>> {
    let sync_ms = median(disk::sync_ms(folder, N_SYNCS_PER_RUN)?);
    Ok(run().map(|run| Run { sync_ms, ..run }))
}

/// The systems take turns, and take turns in being first.
fn measure_changes(folder: &Path, cpp: &Cpp, plan: &Plan) -> io::Result<Vec<Row>> {
    let fewer = |scenario: &Scenario| scenario.shortened(SHARE_OF_WARM_UP);
    let warm_up: Vec<Scenario> = plan.scenarios.iter().map(fewer).collect();
    take_turn(folder, cpp, plan, &warm_up, true)?;
    let mut runs: Vec<[Vec<Run>; 2]> = plan.scenarios.iter().map(|_| Default::default()).collect();
    for turn in 0..N_TURNS {
        let is_ours_first = turn.is_multiple_of(2);
        let found = take_turn(folder, cpp, plan, &plan.scenarios, is_ours_first)?;
        for (runs, run) in runs.iter_mut().flatten().zip(found.into_iter().flatten()) {
            runs.extend(run);
        }
    }
    let rows = plan.scenarios.iter().zip(&runs);
    let rows = rows.map(|(scenario, [ours, cpp])| report::rows_of_runs(&scenario.name, ours, cpp));
    Ok(rows.flatten().collect())
}

/// Loads in a process of its own, so that nothing else is in its memory.
fn load_ours(folder: &Path) -> Load {
    let program = std::env::current_exe().expect("this program");
    cpp::load_of(Command::new(program).arg("--load").arg(folder))
}

fn measure_loading(
    folder: &Path,
    cpp: &Cpp,
    n_views: usize,
    cloud_bytes: usize,
) -> io::Result<Vec<Row>> {
    let [of_ours, copied, of_cpp] = ["ours", "copied", "cpp"].map(|name| folder.join(name));
    ours::fill(&of_ours, n_views, cloud_bytes);
    // C++ LevelDB alters what it opens.
    fs::create_dir(&copied)?;
    for entry in fs::read_dir(of_ours.join("database"))? {
        let entry = entry?;
        fs::copy(entry.path(), copied.join(entry.file_name()))?;
    }
    cpp.copy(&copied, &of_cpp);
    let (mut ours, mut cpps) = (Vec::new(), Vec::new());
    // The first of each warms up.
    for _ in 0..=N_LOADS {
        ours.push(load_ours(&of_ours));
        cpps.push(cpp.load(&of_cpp));
    }
    let loads = ours.iter().chain(&cpps);
    assert!(loads.into_iter().all(|load| load.n_views == n_views as f64));
    for folder in [of_ours, copied, of_cpp] {
        fs::remove_dir_all(folder)?;
    }
    let what = format!("load {n_views} views, clouds of {cloud_bytes} B");
    Ok(report::rows_of_loads(&what, &ours[1..], &cpps[1..]))
}

fn measure(asked: &Asked) -> io::Result<(Disk, Vec<Row>)> {
    fs::create_dir_all(&asked.folder)?;
    let folder = tempfile::tempdir_in(&asked.folder)?;
    let folder = folder.path();
    let syncs_ms = disk::sync_ms(folder, N_SYNCS)?;
    let disk = Disk {
        file_system: disk::file_system(folder)?,
        sync_ms: [0.5, 0.99].map(|share| quantile(syncs_ms.iter().copied(), share)),
    };
    let share = if asked.is_short {
        SHARE_OF_SHORT_RUN
    } else {
        1.0
    };
    let plan = Plan::new(share);
    let trace = folder.join("trace");
    let cpp = Cpp::build(folder, trace.clone());
    trace::write(&plan, &trace)?;
    let mut rows = measure_changes(folder, &cpp, &plan)?;
    let n_views = (N_LOADED_VIEWS as f64 * share) as usize;
    for cloud_bytes in CLOUDS_BYTES {
        rows.extend(measure_loading(folder, &cpp, n_views, cloud_bytes)?);
    }
    Ok((disk, rows))
}

/// A figure of `/proc/self/status`, kilobytes.
fn memory_kb(name: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim_matches(|c: char| !c.is_ascii_digit())
        .parse()
        .ok()
}

/// What the process does that `load_ours` starts.
fn load(folder: &Path) {
    let begin = Instant::now();
    let (opening_ms, _held, n_views) = ours::load(folder);
    let all_ms = begin.elapsed().as_secs_f64() * 1e3;
    let [now, most] = ["VmRSS:", "VmHWM:"].map(|name| memory_kb(name).expect("a figure"));
    println!("{opening_ms} {all_ms} {n_views} {now} {most}");
}

fn parse(arguments: impl Iterator<Item = String>) -> Option<Asked> {
    let mut asked = Asked {
        as_json: false,
        is_short: false,
        // Beside the program, and so on a disk.
        folder: std::env::current_exe().ok()?.parent()?.to_owned(),
    };
    for argument in arguments {
        match argument.as_str() {
            "--json" => asked.as_json = true,
            "--short" => asked.is_short = true,
            other if !other.starts_with('-') => asked.folder = PathBuf::from(other),
            _ => return None,
        }
    }
    Some(asked)
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [verb, folder] = &arguments[..]
        && verb == "--load"
    {
        load(Path::new(folder));
        return ExitCode::SUCCESS;
    }
    let Some(asked) = parse(arguments.into_iter()) else {
        eprintln!("usage: memory [--json] [--short] [FOLDER]");
        return ExitCode::from(2);
    };
    match measure(&asked) {
        Ok((disk, rows)) if asked.as_json => println!("{:#}", report::json(&disk, &rows)),
        Ok((disk, rows)) => print!("{}", report::table(&disk, &rows)),
        Err(error) => {
            eprintln!("memory: {error}; name a folder on a disk with 5 GB free");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
