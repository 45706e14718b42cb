//! C++ LevelDB: the program `leveldb/teach.cc`, built and run.

use std::ffi::OsStr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::figures::{Load, Run};
use crate::plan::{Beside, Plan, Scenario};

pub struct Cpp {
    program: PathBuf,
    trace: PathBuf,
}

impl Cpp {
    /// Builds the program into `folder`.
    pub fn build(folder: &Path, trace: PathBuf) -> Self {
        let program = folder.join("teach");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("leveldb/teach.cc");
        let built = Command::new("g++")
            .args(["-std=c++17", "-O2", "-pthread", "-o"])
            .args([&program, &source])
            .arg("-lleveldb")
            .status();
        let is_built = built.is_ok_and(|status| status.success());
        assert!(is_built, "it needs g++ and libleveldb-dev");
        Self { program, trace }
    }

    /// Makes the steps before those that are timed.
    pub fn prefill(&self, folder: &Path, plan: &Plan) {
        self.write(folder, &plan.prefill(), 1);
    }

    pub fn run(&self, folder: &Path, scenario: &Scenario) -> Run {
        match &scenario.beside {
            Beside::Nothing => self.write(folder, &scenario.steps, scenario.n_callers),
            Beside::Views(views, n) => self.write_beside("views", folder, scenario, views, *n),
            Beside::Compaction => self.write_beside("compaction", folder, scenario, &(0..0), 0),
        }
    }

    fn write(&self, folder: &Path, steps: &Range<usize>, n_callers: usize) -> Run {
        let mut command = self.command("write");
        command.args([folder, &self.trace]);
        command.args(numbers(steps)).arg(n_callers.to_string());
        run_of(&lines_of(command))
    }

    fn write_beside(
        &self,
        what: &str,
        folder: &Path,
        scenario: &Scenario,
        views: &Range<usize>,
        n_callers: usize,
    ) -> Run {
        let mut command = self.command("beside");
        command.arg(what).args([folder, &self.trace]);
        command.args(numbers(&scenario.steps)).args(numbers(views));
        run_of(&lines_of(command.arg(n_callers.to_string())))
    }

    /// Writes all records of a database into a new one.
    pub fn copy(&self, from: &Path, to: &Path) {
        lines_of(self.command("copy").args([from, to]));
    }

    /// Loads in a process of its own.
    pub fn load(&self, folder: &Path) -> Load {
        load_of(self.command("load").arg(folder))
    }

    fn command(&self, verb: &str) -> Command {
        let mut command = Command::new(&self.program);
        command.arg(verb);
        command
    }
}

fn numbers(steps: &Range<usize>) -> [String; 2] {
    [steps.start.to_string(), steps.len().to_string()]
}

fn run_of(lines: &[String]) -> Run {
    let mut ns = lines.iter().map(|line| line.parse().expect("nanoseconds"));
    let elapsed = Duration::from_nanos(ns.next().expect("a time"));
    Run::new(elapsed, ns.collect())
}

/// What a process tells that has loaded.
pub fn load_of(command: &mut Command) -> Load {
    let lines = lines_of(command);
    Load::parse(&lines.concat()).expect("five numbers")
}

/// The lines that a program prints.
fn lines_of(mut command: impl std::borrow::BorrowMut<Command>) -> Vec<String> {
    let command = command.borrow_mut();
    let output = command.output().expect("the program runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    let verb: Vec<&OsStr> = command.get_args().collect();
    assert!(output.status.success(), "{verb:?}: {errors}");
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().map(str::to_owned).collect()
}
