//! C++ LevelDB under test: builds and runs the program `leveldb/teach.cc`.

use std::ffi::OsStr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::timing::{LoadTiming, MutationTiming};
use crate::workload::{BackgroundLoad, Scenario, Workload};

/// Built program with the trace of batches that it replays.
pub struct CppLevelDb {
    program: PathBuf,
    trace: PathBuf,
}

impl CppLevelDb {
    /// Compiles the program with g++ into `folder`.
    ///
    /// # Panics
    /// If g++ or `libleveldb-dev` is missing.
    pub fn build(folder: &Path, trace: PathBuf) -> Self {
        let program = folder.join("teach");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("leveldb/teach.cc");
        let built = Command::new("g++")
            .args(["-std=c++17", "-O2", "-pthread", "-o"])
            .args([&program, &source])
            .arg("-lleveldb")
            .status();
        let is_built = built.is_ok_and(|status| status.success());
        assert!(is_built, "g++ and libleveldb-dev are needed");
        Self { program, trace }
    }

    /// Replays the untimed steps that precede all scenarios.
    pub fn prefill(&self, folder: &Path, workload: &Workload) {
        self.write(folder, &workload.prefill(), 1);
    }

    /// Replays and times the steps of a scenario.
    pub fn run(&self, folder: &Path, scenario: &Scenario) -> MutationTiming {
        match &scenario.background {
            BackgroundLoad::Nothing => self.write(folder, &scenario.steps, scenario.n_callers),
            BackgroundLoad::Views(views, n) => {
                self.write_under_load("views", folder, scenario, views, *n)
            }
            BackgroundLoad::Compaction => {
                self.write_under_load("compaction", folder, scenario, &(0..0), 0)
            }
        }
    }

    /// Synced writes of some steps from several threads.
    fn write(&self, folder: &Path, steps: &Range<usize>, n_callers: usize) -> MutationTiming {
        let mut command = self.command("write");
        command.args([folder, &self.trace]);
        command
            .args(range_arguments(steps))
            .arg(n_callers.to_string());
        parse_mutation_timing(&output_lines(command))
    }

    /// Synced writes from one thread while a background load runs.
    fn write_under_load(
        &self,
        load: &str,
        folder: &Path,
        scenario: &Scenario,
        views: &Range<usize>,
        n_callers: usize,
    ) -> MutationTiming {
        let mut command = self.command("beside");
        command.arg(load).args([folder, &self.trace]);
        command
            .args(range_arguments(&scenario.steps))
            .args(range_arguments(views));
        parse_mutation_timing(&output_lines(command.arg(n_callers.to_string())))
    }

    /// Copies all records of a database into a new one.
    pub fn copy(&self, from: &Path, to: &Path) {
        output_lines(self.command("copy").args([from, to]));
    }

    /// Loads all descriptors in a separate process.
    pub fn load(&self, folder: &Path) -> LoadTiming {
        run_load(self.command("load").arg(folder))
    }

    /// Command line of the program with its verb.
    fn command(&self, verb: &str) -> Command {
        let mut command = Command::new(&self.program);
        command.arg(verb);
        command
    }
}

/// First index and length of a range, as arguments.
fn range_arguments(steps: &Range<usize>) -> [String; 2] {
    [steps.start.to_string(), steps.len().to_string()]
}

/// Parses elapsed nanoseconds, then the latency of each batch, one per line.
fn parse_mutation_timing(lines: &[String]) -> MutationTiming {
    let mut ns = lines.iter().map(|line| line.parse().expect("nanoseconds"));
    let elapsed = Duration::from_nanos(ns.next().expect("an elapsed time"));
    MutationTiming::new(elapsed, ns.collect())
}

/// Runs a process that loads a database, and parses its timing.
pub fn run_load(command: &mut Command) -> LoadTiming {
    let lines = output_lines(command);
    LoadTiming::parse(&lines.concat()).expect("five numbers")
}

/// Standard output of a program, in lines.
///
/// # Panics
/// If the program fails; with its standard error.
fn output_lines(mut command: impl std::borrow::BorrowMut<Command>) -> Vec<String> {
    let command = command.borrow_mut();
    let output = command.output().expect("a program that starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    let verb: Vec<&OsStr> = command.get_args().collect();
    assert!(output.status.success(), "{verb:?}: {errors}");
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().map(str::to_owned).collect()
}
