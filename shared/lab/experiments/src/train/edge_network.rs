//! `tabula-lab train edge-network`: a multilayer perceptron that rates the edges between
//! neighbouring cells as boundaries of objects.

mod generated_source;

use super::{TrainingData, finish};
use crate::arguments::TrainArguments;
use command_line::{Output, progress_bar};
use detection::N_EDGE_FEATURES;
use service::Failure;
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
    let data = TrainingData::read(arguments, output, N_EDGE_FEATURES, |examples, rows| {
        for edge in &examples.edges {
            rows.push(&edge.features, edge.is_boundary);
        }
    })?;
    let bar = progress_bar(PERCEPTRON.n_epochs as u64, "epochs", output);
    let model = Perceptron::train(&data.rows(), &PERCEPTRON, || bar.inc(1));
    bar.finish_and_clear();
    let log_odds = |features: &[f32]| f64::from(model.log_odds(features));
    let report = data.report(PERCEPTRON.n_epochs, Vec::new(), log_odds);
    let source = generated_source::source(&model, &data.names());
    finish(arguments, &source, report, output)
}
