//! `tabula-lab train region-merging`: gradient-boosted trees that decide whether adjacent
//! regions are one object.

mod generated_source;

use super::{SetReport, TrainingData, TrainingReport, TrainingSet, finish, no_examples};
use crate::arguments::TrainArguments;
use command_line::{Output, progress_bar};
use detection::{FEATURE_NAMES, N_FEATURES, RegionPair};
use service::Failure;
use statistics::gradient_boosting::{BoostedTrees, BoostingConfig};
use statistics::labelled_rows::LabelledRows;
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
    let data = TrainingData::read(arguments, output, |examples| examples.edges.clear())?;
    let pairs = || data.train.iter().flat_map(|set| &set.examples.pairs);
    if pairs().next().is_none() {
        return Err(no_examples());
    }
    let features: Vec<f32> = pairs().flat_map(|pair| pair.features).collect();
    let labels: Vec<bool> = pairs().map(|pair| pair.is_one_object).collect();
    let examples = LabelledRows {
        features: &features,
        n_features: N_FEATURES,
        labels: &labels,
    };
    let bar = progress_bar(BOOSTING.n_trees as u64, "trees", output);
    let model = BoostedTrees::train(&examples, &BOOSTING, |_| bar.inc(1));
    bar.finish_and_clear();
    let rated = |pair: &RegionPair| (model.log_odds(&pair.features), pair.is_one_object);
    let report = |set: &TrainingSet| SetReport::of(set, set.examples.pairs.iter().map(rated));
    let report = TrainingReport {
        n_steps: model.trees.len(),
        train: data.train.iter().map(report).collect(),
        test: data.test.iter().map(report).collect(),
        n_uses: n_splits(&model),
        file: String::new(),
    };
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
