//! `tabula-lab train edge-network`: a multilayer perceptron that rates the edges between
//! neighbouring cells as boundaries of objects.

mod generated_source;

use super::{SetReport, TrainingData, TrainingReport, TrainingSet, finish, no_examples};
use crate::arguments::TrainArguments;
use command_line::{Output, progress_bar};
use detection::{EdgeExample, N_EDGE_FEATURES};
use service::Failure;
use statistics::labelled_rows::LabelledRows;
use statistics::multilayer_perceptron::{Perceptron, PerceptronConfig};
use std::process::ExitCode;

/// Settings of the training. Chosen; the held-out figures of the report judge them.
const PERCEPTRON: PerceptronConfig = PerceptronConfig {
    n_hidden: 16,
    n_epochs: 12,
    batch: 256,
    learning_rate: 4e-3,
    seed: 1,
};

/// Trains the network on data sets, judges it on others, and writes the source file.
pub(super) fn run(arguments: &TrainArguments, output: &Output) -> Result<ExitCode, Failure> {
    let data = TrainingData::read(arguments, output, |examples| examples.pairs.clear())?;
    let edges = || data.train.iter().flat_map(|set| &set.examples.edges);
    if edges().next().is_none() {
        return Err(no_examples());
    }
    let features: Vec<f32> = edges().flat_map(|edge| edge.features).collect();
    let labels: Vec<bool> = edges().map(|edge| edge.is_boundary).collect();
    let examples = LabelledRows {
        features: &features,
        n_features: N_EDGE_FEATURES,
        labels: &labels,
    };
    let bar = progress_bar(PERCEPTRON.n_epochs as u64, "epochs", output);
    let model = Perceptron::train(&examples, &PERCEPTRON, || bar.inc(1));
    bar.finish_and_clear();
    let rated = |edge: &EdgeExample| (f64::from(model.log_odds(&edge.features)), edge.is_boundary);
    let report = |set: &TrainingSet| SetReport::of(set, set.examples.edges.iter().map(rated));
    let report = TrainingReport {
        n_steps: PERCEPTRON.n_epochs,
        train: data.train.iter().map(report).collect(),
        test: data.test.iter().map(report).collect(),
        n_uses: Vec::new(),
        file: String::new(),
    };
    let source = generated_source::source(&model, &data.names());
    finish(arguments, &source, report, output)
}
