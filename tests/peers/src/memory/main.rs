//! Store benchmark: durable writes and loading of `shared/memory/store` compared with C++
//! LevelDB, which writes the same bytes.

mod batch_trace;
mod cpp_leveldb;
mod disk;
mod report;
mod tabula_store;
mod timing;
mod workload;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use cpp_leveldb::CppLevelDb;
use report::{DiskProfile, FigureRow};
use timing::{LoadTiming, MutationTiming, median, quantile};
use workload::{Scenario, Workload};

/// Number of interleaved rounds.
const N_ROUNDS: usize = 5;
/// Number of bare syncs timed at the start, to characterise the disk.
const N_SYNCS: usize = 500;
/// Number of bare syncs timed before each run.
const N_SYNCS_PER_RUN: usize = 20;
/// Number of timed loads, after one that warms up.
const N_LOADS: usize = 5;
/// Number of views in the loading benchmark.
const N_LOADED_VIEWS: usize = 100_000;
/// Sizes of a view's point cloud in the loading benchmark, bytes.
const CLOUDS_BYTES: [usize; 2] = [0, 5_000];
/// Share of each scenario's steps in the warm-up round.
const WARM_UP_SHARE: f64 = 0.1;
/// Share of all counts with `--short`.
const SHORT_RUN_SHARE: f64 = 0.1;

/// Command-line options.
struct Options {
    /// `true` for JSON, `false` for a table.
    as_json: bool,
    /// `true` for a tenth of all counts.
    is_short: bool,
    /// Folder in which the databases are created.
    folder: PathBuf,
}

/// One round: times all scenarios of both stores on new databases.
fn run_round(
    folder: &Path,
    cpp: &CppLevelDb,
    workload: &Workload,
    scenarios: &[Scenario],
    is_ours_first: bool,
) -> io::Result<Vec<[Option<MutationTiming>; 2]>> {
    let [of_ours, of_cpp] = ["ours", "cpp"].map(|name| folder.join(name));
    tabula_store::prefill(&of_ours, workload);
    cpp.prefill(&of_cpp, workload);
    let mut runs = Vec::with_capacity(scenarios.len());
    for scenario in scenarios {
        let run_ours = || timed(folder, || tabula_store::run(&of_ours, workload, scenario));
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

/// Timing of a run with a disk baseline just before, because the speed of disks varies.
fn timed(
    folder: &Path,
    run: impl FnOnce() -> Option<MutationTiming>,
) -> io::Result<Option<MutationTiming>> {
    let sync_ms = median(disk::sync_ms(folder, N_SYNCS_PER_RUN)?);
    Ok(run().map(|run| MutationTiming { sync_ms, ..run }))
}

/// Interleaved benchmark of all scenarios; the stores alternate in running first.
fn measure_changes(
    folder: &Path,
    cpp: &CppLevelDb,
    workload: &Workload,
) -> io::Result<Vec<FigureRow>> {
    let fewer = |scenario: &Scenario| scenario.truncated(WARM_UP_SHARE);
    let warm_up: Vec<Scenario> = workload.scenarios.iter().map(fewer).collect();
    run_round(folder, cpp, workload, &warm_up, true)?;
    let mut runs: Vec<[Vec<MutationTiming>; 2]> = workload
        .scenarios
        .iter()
        .map(|_| Default::default())
        .collect();
    for round in 0..N_ROUNDS {
        let is_ours_first = round.is_multiple_of(2);
        let found = run_round(folder, cpp, workload, &workload.scenarios, is_ours_first)?;
        for (runs, run) in runs.iter_mut().flatten().zip(found.into_iter().flatten()) {
            runs.extend(run);
        }
    }
    let rows = workload.scenarios.iter().zip(&runs);
    let rows = rows.map(|(scenario, [ours, cpp])| report::mutation_rows(&scenario.name, ours, cpp));
    Ok(rows.flatten().collect())
}

/// Loads the store in a separate process, whose memory holds nothing else.
fn load_ours(folder: &Path) -> LoadTiming {
    let program = std::env::current_exe().expect("this program");
    cpp_leveldb::run_load(Command::new(program).arg("--load").arg(folder))
}

/// Loading benchmark of both stores with the same records.
fn measure_loading(
    folder: &Path,
    cpp: &CppLevelDb,
    n_views: usize,
    cloud_bytes: usize,
) -> io::Result<Vec<FigureRow>> {
    let [of_ours, copied, of_cpp] = ["ours", "copied", "cpp"].map(|name| folder.join(name));
    tabula_store::fill(&of_ours, n_views, cloud_bytes);
    // C++ LevelDB modifies the files that it opens.
    fs::create_dir(&copied)?;
    for entry in fs::read_dir(of_ours.join("database"))? {
        let entry = entry?;
        fs::copy(entry.path(), copied.join(entry.file_name()))?;
    }
    cpp.copy(&copied, &of_cpp);
    let (mut ours, mut cpps) = (Vec::new(), Vec::new());
    // The first load of each store only warms up.
    for _ in 0..=N_LOADS {
        ours.push(load_ours(&of_ours));
        cpps.push(cpp.load(&of_cpp));
    }
    let loads = ours.iter().chain(&cpps);
    assert!(loads.into_iter().all(|load| load.n_views == n_views as f64));
    for folder in [of_ours, copied, of_cpp] {
        fs::remove_dir_all(folder)?;
    }
    let scenario = format!("load {n_views} views, clouds of {cloud_bytes} B");
    Ok(report::load_rows(&scenario, &ours[1..], &cpps[1..]))
}

/// Runs the whole benchmark in a temporary folder.
fn measure(options: &Options) -> io::Result<(DiskProfile, Vec<FigureRow>)> {
    fs::create_dir_all(&options.folder)?;
    let folder = tempfile::tempdir_in(&options.folder)?;
    let folder = folder.path();
    let syncs_ms = disk::sync_ms(folder, N_SYNCS)?;
    let disk = DiskProfile {
        file_system: disk::file_system(folder)?,
        sync_ms: [0.5, 0.99].map(|share| quantile(syncs_ms.iter().copied(), share)),
    };
    let share = if options.is_short {
        SHORT_RUN_SHARE
    } else {
        1.0
    };
    let workload = Workload::new(share);
    let trace = folder.join("trace");
    let cpp = CppLevelDb::build(folder, trace.clone());
    batch_trace::write(&workload, &trace)?;
    let mut rows = measure_changes(folder, &cpp, &workload)?;
    let n_views = (N_LOADED_VIEWS as f64 * share) as usize;
    for cloud_bytes in CLOUDS_BYTES {
        rows.extend(measure_loading(folder, &cpp, n_views, cloud_bytes)?);
    }
    Ok((disk, rows))
}

/// Field of `/proc/self/status`, kilobytes.
fn memory_kb(name: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim_matches(|c: char| !c.is_ascii_digit())
        .parse()
        .ok()
}

/// Child process of [`load_ours`]: loads the store and prints the timing and the memory.
fn load(folder: &Path) {
    let begin = Instant::now();
    let (opening_ms, _held, n_views) = tabula_store::load(folder);
    let total_ms = begin.elapsed().as_secs_f64() * 1e3;
    let [now, most] = ["VmRSS:", "VmHWM:"].map(|name| memory_kb(name).expect("a figure"));
    println!("{opening_ms} {total_ms} {n_views} {now} {most}");
}

/// Parses the command line; `None` if invalid.
fn parse(arguments: impl Iterator<Item = String>) -> Option<Options> {
    let mut options = Options {
        as_json: false,
        is_short: false,
        // Next to the program, so not in memory.
        folder: std::env::current_exe().ok()?.parent()?.to_owned(),
    };
    for argument in arguments {
        match argument.as_str() {
            "--json" => options.as_json = true,
            "--short" => options.is_short = true,
            other if !other.starts_with('-') => options.folder = PathBuf::from(other),
            _ => return None,
        }
    }
    Some(options)
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [verb, folder] = &arguments[..]
        && verb == "--load"
    {
        load(Path::new(folder));
        return ExitCode::SUCCESS;
    }
    let Some(options) = parse(arguments.into_iter()) else {
        eprintln!("usage: memory [--json] [--short] [FOLDER]");
        return ExitCode::from(2);
    };
    match measure(&options) {
        Ok((disk, rows)) if options.as_json => println!("{:#}", report::json(&disk, &rows)),
        Ok((disk, rows)) => print!("{}", report::table(&disk, &rows)),
        Err(error) => {
            eprintln!("memory: {error}; name a folder on a disk with 5 GB free");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
