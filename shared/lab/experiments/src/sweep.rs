//! Sensitivity sweep: scores with one tuned constant halved and doubled at a time.
//!
//! Constants are compiled into the kernels, so each value is a build of its own: the
//! workspace is copied into a scratch folder, the constant's definition is scaled in
//! the copy, `tabula-lab` is built there without link-time optimisation, and its
//! `evaluate` gives the scores. One value takes about a minute.

mod constant;
mod measurement;
mod report;
mod scratch_workspace;

use crate::arguments::SweepArguments;
use crate::output_files::create_folder;
use command_line::{Output, progress_bar};
use constant::Constant;
use measurement::Measurement;
use report::{SweepReport, SweepRow};
use scratch_workspace::ScratchWorkspace;
use service::Failure;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Scales each constant by each factor and writes the changes of the scores.
///
/// # Errors
/// When a constant is not found, a build fails with the original values, or a score
/// is missing. A scaled value that does not build or run is reported in its row.
pub fn run(arguments: &SweepArguments, output: &Output) -> Result<ExitCode, Failure> {
    let root = workspace_root()?;
    let constants = named_constants(&root, &arguments.constants)?;
    let measure = Measurement::new(arguments)?;
    create_folder(&arguments.out)?;
    let scratch = ScratchWorkspace::copy(&root)?;
    let n_steps = 1 + constants.len() * arguments.factors.len();
    let bar = progress_bar(n_steps as u64, "builds and evaluations", output);
    let mut report = SweepReport::new(&measure, scratch.scores(&measure, &arguments.out)?);
    bar.inc(1);
    for constant in &constants {
        for factor in &arguments.factors {
            let scaled = constant.scaled(*factor)?;
            let scores = scratch.with_file(&constant.file, &scaled, || {
                scratch.scores(&measure, &arguments.out)
            })?;
            report.push(SweepRow::new(constant, *factor, scores));
            // Written after every step: a long run that is stopped has what it did.
            report.write(&arguments.out)?;
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    report.write(&arguments.out)?;
    output.answer(&report, || report.text());
    Ok(ExitCode::SUCCESS)
}

/// Root of the workspace that contains the current folder.
fn workspace_root() -> Result<PathBuf, Failure> {
    let here = std::env::current_dir().map_err(Failure::general)?;
    let is_root = |folder: &&Path| {
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml"));
        manifest.is_ok_and(|text| text.contains("[workspace]")) && folder.join("shared").is_dir()
    };
    let root = here.ancestors().find(is_root).map(Path::to_owned);
    root.ok_or_else(|| {
        let sentence = "a sweep builds the kernels: call it in the source tree of tabula";
        Failure::usage(sentence)
    })
}

/// Constants that the arguments name as `FILE:NAME` or `FILE`, in their order.
fn named_constants(root: &Path, names: &[String]) -> Result<Vec<Constant>, Failure> {
    let mut constants = Vec::new();
    for name in names {
        let (file, wanted) = match name.split_once(':') {
            Some((file, wanted)) => (file, Some(wanted)),
            None => (name.as_str(), None),
        };
        let text = std::fs::read_to_string(root.join(file))
            .map_err(|error| Failure::usage(format!("{file} cannot be read: {error}")))?;
        let found = constant::all(Path::new(file), &text);
        let before = constants.len();
        let is_wanted = |constant: &Constant| wanted.is_none_or(|wanted| constant.name == wanted);
        constants.extend(found.into_iter().filter(is_wanted));
        if constants.len() == before {
            return Err(Failure::usage(format!(
                "{name}: no number constant of that name"
            )));
        }
    }
    Ok(constants)
}
