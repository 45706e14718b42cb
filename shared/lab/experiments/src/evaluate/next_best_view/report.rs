//! Report of the next best view.

use super::closed_loop::N_VIEWS_MAX;
use super::entropy_prediction::PredictionScore;
use super::loop_method::Method;
use super::method_report::{self, MethodReport};
use super::pose_accuracy::PoseCounts;
use super::prediction_source::PredictionSource;
use super::scene_result::{SceneResult, ViewFigures};
use super::statistic_report::{KindReport, KindScenes};
use crate::arguments::NextBestViewArguments;
use serde::Serialize;
use statistics::bootstrap::Estimate;
use statistics::correlation::{pearson, spearman};
use std::collections::BTreeMap;
use view_planning::PlanSettings;

/// Report of the next best view.
#[derive(Debug, Serialize)]
pub(super) struct NextBestViewReport {
    pub(super) version: &'static str,
    pub(super) seed: u64,
    pub(super) models: String,
    pub(super) n_scenes: usize,
    pub(super) n_views: u32,
    pub(super) n_starts: u32,
    pub(super) n_lesson_heaps: u32,
    pub(super) sigma_share: f64,
    pub(super) visited_share: f64,
    pub(super) gain_weight: f64,
    /// Correlation of true entropy and F1 of detection with recognition over the views, mean of the
    /// scenes.
    pub(super) pearson_r: f64,
    pub(super) spearman_rho: f64,
    /// Means with their 95 % intervals over the scenes.
    pub(super) intervals: CorrelationIntervals,
    /// Mean absolute error of entropies that are predicted from registered models, bit.
    pub(super) entropy_mae: f64,
    /// Mean loss of entropy by choosing on the prediction, bit.
    pub(super) regret: f64,
    /// Mean number of views until 95 % of the objects were found, by the greedy choice.
    pub(super) views_to_95: f64,
    /// Recognition and registration over the segments of all views.
    pub(super) poses: PoseCounts,
    pub(super) predictions: BTreeMap<&'static str, PredictionScore>,
    /// Statistic of figure 8 of the paper, one entry for each kind of scene.
    pub(super) published_statistic: Vec<KindReport>,
    pub(super) methods: BTreeMap<&'static str, MethodReport>,
    pub(super) scenes: Vec<SceneReport>,
}

/// Correlations over the views with their 95 % intervals over the scenes.
#[derive(Debug, Serialize)]
pub(super) struct CorrelationIntervals {
    pub(super) pearson_r: Option<Estimate>,
    pub(super) spearman_rho: Option<Estimate>,
    /// With entropy over the area of the objects alone.
    pub(super) pearson_r_objects_only: Option<Estimate>,
    /// Of mean visibility and F1.
    pub(super) pearson_r_visibility: Option<Estimate>,
    /// Of entropy and F1 of detection alone, without recognition.
    pub(super) pearson_r_detection: Option<Estimate>,
}

/// Figures of one scene.
#[derive(Debug, Serialize)]
pub(super) struct SceneReport {
    pub(super) seed: u64,
    pub(super) n_objects: usize,
    pub(super) n_findable: usize,
    pub(super) pearson_r: Option<f64>,
    pub(super) spearman_rho: Option<f64>,
    /// Means over the views.
    pub(super) entropy: f64,
    pub(super) visibility: f64,
    pub(super) f1: f64,
    pub(super) detection_f1: f64,
    pub(super) n_detected: f64,
}

impl NextBestViewReport {
    /// Report of the results of all scenes.
    pub(super) fn of(
        arguments: &NextBestViewArguments,
        settings: &PlanSettings,
        scenes: &[SceneResult],
        twins: &[KindScenes],
    ) -> Self {
        let intervals = CorrelationIntervals::of(scenes, arguments.seed);
        let predictions = predictions(scenes);
        let of_source = |source: PredictionSource| {
            let score = predictions.get(source.word());
            score.copied().unwrap_or_default()
        };
        let own = of_source(PredictionSource::Registered);
        let noisy_truth = of_source(PredictionSource::NoisyTruth);
        let methods = method_report::all(scenes, (&own, &noisy_truth), arguments.seed);
        let value = |estimate: Option<Estimate>| estimate.map_or(0.0, |estimate| estimate.value);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            seed: arguments.seed,
            models: arguments.models.to_string(),
            n_scenes: scenes.len(),
            n_views: arguments.views,
            n_starts: arguments.starts,
            n_lesson_heaps: arguments.lesson_heaps,
            sigma_share: settings.sigma_share,
            visited_share: settings.visited_share,
            gain_weight: settings.gain_weight,
            pearson_r: value(intervals.pearson_r),
            spearman_rho: value(intervals.spearman_rho),
            intervals,
            entropy_mae: own.mae,
            regret: own.regret,
            views_to_95: methods
                .get(Method::Greedy.word())
                .map_or(N_VIEWS_MAX as f64, |method| method.views_to_95),
            poses: PoseCounts::sum(scenes.iter().map(|scene| scene.poses)),
            predictions,
            published_statistic: twins.iter().map(KindReport::of).collect(),
            methods,
            scenes: scenes.iter().map(SceneReport::of).collect(),
        }
    }
}

impl CorrelationIntervals {
    fn of(scenes: &[SceneResult], seed: u64) -> Self {
        let mean = |correlation: fn(&[(f64, f64)]) -> Option<f64>,
                    figures: fn(&ViewFigures) -> (f64, f64)| {
            let of_scene = |scene: &SceneResult| correlation(&pairs(&scene.views, figures));
            let values: Vec<Option<f64>> = scenes.iter().map(of_scene).collect();
            Estimate::mean(&values, seed)
        };
        Self {
            pearson_r: mean(pearson, |view| (view.entropy, view.f1)),
            spearman_rho: mean(spearman, |view| (view.entropy, view.f1)),
            pearson_r_objects_only: mean(pearson, |view| (view.object_entropy, view.f1)),
            pearson_r_visibility: mean(pearson, |view| (view.visibility, view.f1)),
            pearson_r_detection: mean(pearson, |view| (view.entropy, view.detection_f1)),
        }
    }
}

impl SceneReport {
    fn of(scene: &SceneResult) -> Self {
        let n = scene.views.len().max(1) as f64;
        let mean = |value: fn(&ViewFigures) -> f64| scene.views.iter().map(value).sum::<f64>() / n;
        let by_entropy = pairs(&scene.views, |view| (view.entropy, view.f1));
        Self {
            seed: scene.seed,
            n_objects: scene.n_objects,
            n_findable: scene.n_findable,
            pearson_r: pearson(&by_entropy),
            spearman_rho: spearman(&by_entropy),
            entropy: mean(|view| view.entropy),
            visibility: mean(|view| view.visibility),
            f1: mean(|view| view.f1),
            detection_f1: mean(|view| view.detection_f1),
            n_detected: mean(|view| view.n_detected as f64),
        }
    }
}

/// Two figures of each view.
fn pairs(views: &[ViewFigures], figures: fn(&ViewFigures) -> (f64, f64)) -> Vec<(f64, f64)> {
    views.iter().map(figures).collect()
}

fn predictions(scenes: &[SceneResult]) -> BTreeMap<&'static str, PredictionScore> {
    let of_source = |source: PredictionSource| {
        let of_scenes = scenes.iter().flat_map(|scene| &scene.predictions);
        let scores = of_scenes
            .filter(|(of, _)| *of == source)
            .map(|(_, score)| *score);
        PredictionScore::mean(&scores.collect::<Vec<_>>())
    };
    let sources = PredictionSource::ALL.into_iter();
    sources
        .map(|source| (source.word(), of_source(source)))
        .collect()
}
