//! `tabula-lab train region-merging`: gradient-boosted trees that decide whether adjacent
//! regions are one object.

mod generated_source;

use crate::arguments::RegionMergingArguments;
use crate::output_files::write;
use command_line::{Output, format_table, progress_bar};
use detection::{Config, DetectionInput, FEATURE_NAMES, N_FEATURES, RegionPair, ScenePriors};
use detection::{Workspace, region_pairs};
use evaluation::labelled_scenes::{LabelledScene, LabelledScenes};
use evaluation::segmentation_score::FIRST_OBJECT_LABEL;
use point_cloud::OrganizedCloud;
use serde::Serialize;
use service::Failure;
use statistics::gradient_boosting::{BoostedTrees, BoostingConfig, Examples};
use std::path::Path;
use std::process::ExitCode;

/// Settings of the boosting. Chosen; the held-out figures of the report judge them.
const BOOSTING: BoostingConfig = BoostingConfig {
    n_trees: 240,
    depth: 4,
    learning_rate: 0.1,
    lambda: 2.0,
    hessian_min: 4.0,
};

/// Report of the training.
#[derive(Debug, Serialize)]
struct TrainingReport {
    n_trees: usize,
    train: Vec<SetReport>,
    test: Vec<SetReport>,
    /// Number of splits by each feature, most first.
    n_splits: Vec<(&'static str, usize)>,
    file: String,
}

/// Classification of the pairs of one data set.
#[derive(Debug, Serialize)]
struct SetReport {
    dataset: String,
    n_scenes: usize,
    n_pairs: usize,
    n_one_object: usize,
    /// Area under the receiver operating characteristic.
    auroc: Option<f64>,
    /// Mean logistic loss.
    log_loss: f64,
    /// Share of wrong decisions at even odds.
    error_rate: f64,
}

/// Pairs of one data set.
struct PairSet {
    dataset: String,
    n_scenes: usize,
    pairs: Vec<RegionPair>,
}

/// Trains the trees on data sets, judges them on others, and writes the source file.
pub(super) fn run(
    arguments: &RegionMergingArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let read = |folders: &[std::path::PathBuf]| {
        let sets = folders.iter().map(|folder| PairSet::read(folder, output));
        sets.collect::<Result<Vec<_>, _>>()
    };
    let train = read(&arguments.datasets)?;
    let test = read(&arguments.test)?;
    let pairs: Vec<&RegionPair> = train.iter().flat_map(|set| &set.pairs).collect();
    if pairs.is_empty() {
        return Err(Failure::general(
            "the data sets have no pair of adjacent regions to learn from; simulate scenes in \
             which objects touch, for example with: tabula simulate scene --kind clutter",
        ));
    }
    let features: Vec<f32> = pairs.iter().flat_map(|pair| pair.features).collect();
    let labels: Vec<bool> = pairs.iter().map(|pair| pair.is_one_object).collect();
    let examples = Examples {
        features: &features,
        n_features: N_FEATURES,
        labels: &labels,
    };
    let bar = progress_bar(BOOSTING.n_trees as u64, "trees", output);
    let model = BoostedTrees::train(&examples, &BOOSTING, |_| bar.inc(1));
    bar.finish_and_clear();
    let source =
        generated_source::source(&model, &train.iter().map(PairSet::name).collect::<Vec<_>>());
    write(&arguments.out, source.as_bytes())?;
    let report = TrainingReport {
        n_trees: model.trees.len(),
        train: train.iter().map(|set| set.report(&model)).collect(),
        test: test.iter().map(|set| set.report(&model)).collect(),
        n_splits: n_splits(&model),
        file: arguments.out.display().to_string(),
    };
    output.answer(&report, || text(&report));
    Ok(ExitCode::SUCCESS)
}

impl PairSet {
    /// Reads the pairs of all organised scenes of a data set.
    fn read(folder: &Path, output: &Output) -> Result<Self, Failure> {
        let scenes = LabelledScenes::open(folder).map_err(Failure::usage)?;
        let mut set = Self {
            dataset: folder.display().to_string(),
            n_scenes: 0,
            pairs: Vec::new(),
        };
        let mut workspace = Workspace::default();
        let bar = progress_bar(scenes.entries().len() as u64, "scenes", output);
        for entry in scenes.entries() {
            let scene = scenes.read(entry).map_err(Failure::general)?;
            if scene.height > 1 {
                set.add_scene(&scene, &mut workspace)?;
            }
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(set)
    }

    fn add_scene(
        &mut self,
        scene: &LabelledScene,
        workspace: &mut Workspace,
    ) -> Result<(), Failure> {
        let cloud = OrganizedCloud::new(&scene.points, scene.width, scene.height);
        let frame = DetectionInput {
            cloud: cloud.map_err(Failure::general)?,
            up_in_camera: scene.up_in_camera,
            seed: self.n_scenes as u64,
            priors: ScenePriors::default(),
        };
        let object = |&label: &u16| (label >= FIRST_OBJECT_LABEL).then_some(label);
        let objects: Vec<Option<u16>> = scene.labels.iter().map(object).collect();
        let config = Config::default();
        region_pairs(&frame, &config, workspace, &objects, &mut self.pairs);
        self.n_scenes += 1;
        Ok(())
    }

    /// Name of the data set: the last part of its folder.
    fn name(&self) -> &str {
        self.dataset
            .trim_end_matches('/')
            .rsplit('/')
            .next()
            .unwrap_or(&self.dataset)
    }

    fn report(&self, model: &BoostedTrees) -> SetReport {
        let mut scored: Vec<(f64, bool)> = self
            .pairs
            .iter()
            .map(|pair| (model.log_odds(&pair.features), pair.is_one_object))
            .collect();
        scored.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = scored.len().max(1) as f64;
        let loss = |&(odds, truth): &(f64, bool)| (if truth { -odds } else { odds }).exp().ln_1p();
        let is_wrong = |&&(odds, truth): &&(f64, bool)| (odds > 0.0) != truth;
        SetReport {
            dataset: self.dataset.clone(),
            n_scenes: self.n_scenes,
            n_pairs: scored.len(),
            n_one_object: scored.iter().filter(|(_, truth)| *truth).count(),
            auroc: auroc(&scored),
            log_loss: scored.iter().map(loss).sum::<f64>() / n,
            error_rate: scored.iter().filter(is_wrong).count() as f64 / n,
        }
    }
}

/// Area under the receiver operating characteristic of scores in ascending order; `None`
/// with one class only.
fn auroc(scored: &[(f64, bool)]) -> Option<f64> {
    let (mut n_false, mut n_true, mut n_ordered) = (0_u64, 0_u64, 0_u64);
    for (_, truth) in scored {
        if *truth {
            n_true += 1;
            n_ordered += n_false;
        } else {
            n_false += 1;
        }
    }
    let n_both = n_false * n_true;
    (n_both > 0).then(|| n_ordered as f64 / n_both as f64)
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

/// Report as text for the terminal.
fn text(report: &TrainingReport) -> String {
    let heading = [
        "",
        "scenes",
        "pairs",
        "one object",
        "AUROC",
        "log loss",
        "wrong %",
    ];
    let row = |part: &str, set: &SetReport| {
        vec![
            format!("{part} {}", set.dataset),
            set.n_scenes.to_string(),
            set.n_pairs.to_string(),
            set.n_one_object.to_string(),
            set.auroc
                .map_or_else(|| "-".into(), |auroc| format!("{auroc:.4}")),
            format!("{:.4}", set.log_loss),
            format!("{:.1}", 100.0 * set.error_rate),
        ]
    };
    let train = report.train.iter().map(|set| row("trained on", set));
    let test = report.test.iter().map(|set| row("held out:", set));
    let rows: Vec<Vec<String>> = train.chain(test).collect();
    let features = report.n_splits.iter();
    let features: Vec<Vec<String>> = features
        .map(|(name, n)| vec![n.to_string(), (*name).to_owned()])
        .collect();
    [
        format_table(&heading, &rows),
        String::new(),
        format_table(&["splits", "feature"], &features),
        String::new(),
        report.file.clone(),
    ]
    .join("\n")
}
