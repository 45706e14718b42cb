//! `tabula-lab train`: models that are trained on simulated scenes.

mod classification_report;
mod color_augmentation;
mod edge_network;
mod region_merging;
mod training_set;

use crate::arguments::{TrainArguments, TrainVerb};
use crate::output_files::write;
use classification_report::{SetReport, set_table};
use command_line::{Output, format_table};
use detection::SegmentationExamples;
use serde::Serialize;
use service::Failure;
use std::process::ExitCode;
use training_set::TrainingSet;

/// Runs a subcommand of `tabula-lab train`.
///
/// # Errors
/// When a data set cannot be read or has no examples, or a file cannot be written.
pub fn run(verb: &TrainVerb, output: &Output) -> Result<ExitCode, Failure> {
    match verb {
        TrainVerb::EdgeNetwork(arguments) => edge_network::run(arguments, output),
        TrainVerb::RegionMerging(arguments) => region_merging::run(arguments, output),
    }
}

/// Report of a training.
#[derive(Debug, Serialize)]
struct TrainingReport {
    /// Number of passes over the examples, or of trees.
    n_steps: usize,
    train: Vec<SetReport>,
    test: Vec<SetReport>,
    /// Number of uses of each feature, most first.
    n_uses: Vec<(&'static str, usize)>,
    file: String,
}

/// Data sets to train on and to judge on.
struct TrainingData {
    train: Vec<TrainingSet>,
    test: Vec<TrainingSet>,
}

impl TrainingData {
    /// Reads the data sets of a training; `pick` drops the examples that it does not need.
    fn read(
        arguments: &TrainArguments,
        output: &Output,
        pick: impl Fn(&mut SegmentationExamples),
    ) -> Result<Self, Failure> {
        let read = |folders: &[std::path::PathBuf]| {
            let sets = folders
                .iter()
                .map(|folder| TrainingSet::read(folder, output, &pick));
            sets.collect::<Result<Vec<_>, _>>()
        };
        Ok(Self {
            train: read(&arguments.datasets)?,
            test: read(&arguments.test)?,
        })
    }

    /// Names of the data sets to train on.
    fn names(&self) -> String {
        let names: Vec<&str> = self.train.iter().map(TrainingSet::name).collect();
        names.join(" ")
    }
}

/// Writes the source file of a trained model, and answers with the report.
fn finish(
    arguments: &TrainArguments,
    source: &str,
    mut report: TrainingReport,
    output: &Output,
) -> Result<ExitCode, Failure> {
    write(&arguments.out, source.as_bytes())?;
    report.file = arguments.out.display().to_string();
    output.answer(&report, || text(&report));
    Ok(ExitCode::SUCCESS)
}

/// Report as text for the terminal.
fn text(report: &TrainingReport) -> String {
    let uses = report.n_uses.iter();
    let uses: Vec<Vec<String>> = uses
        .map(|(name, n)| vec![n.to_string(), (*name).to_owned()])
        .collect();
    let mut parts = vec![set_table(&report.train, &report.test), String::new()];
    if !uses.is_empty() {
        parts.extend([format_table(&["uses", "feature"], &uses), String::new()]);
    }
    parts.push(report.file.clone());
    parts.join("\n")
}

/// Error of a training without examples.
fn no_examples() -> Failure {
    Failure::general(
        "the data sets have no objects that touch to learn from; simulate some, for example \
         with: tabula simulate scene --kind clutter",
    )
}
