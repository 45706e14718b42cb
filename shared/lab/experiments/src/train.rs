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
use statistics::labelled_rows::LabelledRows;
use std::process::ExitCode;
use training_set::{Rows, TrainingSet};

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
    n_features: usize,
    train: Vec<TrainingSet>,
    test: Vec<TrainingSet>,
    /// Rows of all data sets to train on.
    rows: Rows,
}

impl TrainingData {
    /// Reads the data sets of a training; `add_rows` adds the examples of a scene that it needs,
    /// with `n_features` each.
    fn read(
        arguments: &TrainArguments,
        output: &Output,
        n_features: usize,
        add_rows: impl Fn(&SegmentationExamples, &mut Rows) + Sync,
    ) -> Result<Self, Failure> {
        let read = |folders: &[std::path::PathBuf]| {
            let sets = folders
                .iter()
                .map(|folder| TrainingSet::read(folder, output, &add_rows));
            sets.collect::<Result<Vec<_>, _>>()
        };
        let train = read(&arguments.datasets)?;
        let mut rows = Rows::default();
        for set in &train {
            rows.features.extend_from_slice(&set.rows.features);
            rows.labels.extend_from_slice(&set.rows.labels);
        }
        if rows.labels.is_empty() {
            return Err(no_examples());
        }
        Ok(Self {
            n_features,
            train,
            test: read(&arguments.test)?,
            rows,
        })
    }

    /// Rows of all data sets to train on.
    fn rows(&self) -> LabelledRows<'_> {
        LabelledRows {
            features: &self.rows.features,
            n_features: self.n_features,
            labels: &self.rows.labels,
        }
    }

    /// Report on a model that gives rows `log_odds` after a number of steps, with the number of
    /// uses of each feature.
    fn report(
        &self,
        n_steps: usize,
        n_uses: Vec<(&'static str, usize)>,
        log_odds: impl Fn(&[f32]) -> f64,
    ) -> TrainingReport {
        let report = |set: &TrainingSet| SetReport::of(set, self.n_features, &log_odds);
        TrainingReport {
            n_steps,
            train: self.train.iter().map(report).collect(),
            test: self.test.iter().map(report).collect(),
            n_uses,
            file: String::new(),
        }
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
