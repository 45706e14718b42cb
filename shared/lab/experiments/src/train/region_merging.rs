//! `tabula-lab train region-merging`: gradient-boosted trees that decide whether adjacent
//! regions are one object.

mod generated_source;

use super::{TrainingData, finish};
use crate::arguments::TrainArguments;
use command_line::{Output, progress_bar};
use detection::{FEATURE_NAMES, N_FEATURES};
use service::Failure;
use statistics::gradient_boosting::{BoostedTrees, BoostingConfig};
use std::process::ExitCode;

/// Settings of the boosting. Chosen; the held-out figures of the report judge them.
const BOOSTING: BoostingConfig = BoostingConfig {
    n_trees: 400,
    depth: 6,
    learning_rate: 0.1,
    lambda: 2.0,
    hessian_min: 4.0,
    subsample: 0.25,
    seed: 1,
};

/// Trains the trees on data sets, judges them on others, and writes the source file.
pub(super) fn run(arguments: &TrainArguments, output: &Output) -> Result<ExitCode, Failure> {
    let data = TrainingData::read(arguments, output, N_FEATURES, |examples, rows| {
        for pair in &examples.pairs {
            rows.push(&pair.features, pair.is_one_object);
        }
    })?;
    let bar = progress_bar(BOOSTING.n_trees as u64, "trees", output);
    let model = BoostedTrees::train(&data.rows(), &BOOSTING, |_| bar.inc(1));
    bar.finish_and_clear();
    let log_odds = |features: &[f32]| model.log_odds(features);
    let report = data.report(model.trees.len(), n_splits(&model), log_odds);
    let source = generated_source::source(&model, &data.names());
    finish(arguments, &source, report, output)
}

/// Number of splits by each feature, most first.
fn n_splits(model: &BoostedTrees) -> Vec<(&'static str, usize)> {
    let mut counts: Vec<(&str, usize)> = FEATURE_NAMES.map(|name| (name, 0)).into();
    let splits = model.trees.iter().flat_map(|tree| &tree.splits);
    for (feature, _) in splits.filter(|(_, threshold)| *threshold < f32::MAX) {
        counts[*feature].1 += 1;
    }
    counts.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    counts
}
