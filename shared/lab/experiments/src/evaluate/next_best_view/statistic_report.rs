//! Report of the published statistic: figures for each kind of scene, beside those of the paper.

use super::bin_picking_twin::TwinKind;
use super::entropy_prediction::PredictionScore;
use super::prediction_source::PredictionSource;
use super::published_statistic::{DRAWN, PaperFigures, SceneStatistic, SourceStatistic, spread};
use crate::evaluate::tabular_report::{ReportTable, number, percent};
use plot::DrawingError;
use plot::box_plot::{BoxGroup, BoxPlot, stacked};
use serde::Serialize;
use std::collections::BTreeMap;

/// Figure of the predictions beside the truth, as figure 8 of the paper.
pub(super) const STATISTIC: &str = "published-statistic.svg";
/// Caption of the figure.
pub(super) const CAPTION: &str = "Ten best predictions of each view and its true entropy, as in \
                                  figure 8 of the paper";
/// Scenes of one kind.
#[derive(Debug)]
pub(super) struct KindScenes {
    pub(super) kind: &'static str,
    pub(super) paper: Option<PaperFigures>,
    pub(super) scenes: Vec<SceneStatistic>,
}

/// Statistic of one kind of scene.
#[derive(Debug, Serialize)]
pub(super) struct KindReport {
    pub(super) kind: &'static str,
    pub(super) n_scenes: usize,
    pub(super) n_objects: usize,
    pub(super) n_views: usize,
    /// Greatest possible entropy: that of equal areas of all objects without background, bit.
    pub(super) entropy_max: f64,
    pub(super) paper_sd: Option<f64>,
    pub(super) paper_mse: Option<f64>,
    /// Means of the scenes, by source of the hypotheses.
    pub(super) sources: BTreeMap<&'static str, SourceReport>,
}

/// Statistic from one source of hypotheses.
#[derive(Debug, Serialize)]
pub(super) struct SourceReport {
    #[serde(flatten)]
    pub(super) statistic: SourceStatistic,
    /// Standard deviation over the scenes; null for a single scene.
    pub(super) over_scenes: Option<Deviations>,
}

/// Standard deviations over the scenes, in the units of the figures.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Deviations {
    pub(super) best_ten_sd: f64,
    pub(super) best_ten_mse: f64,
    pub(super) mae: f64,
    pub(super) regret: f64,
}

impl KindReport {
    /// Report of the scenes of a kind, which have equally many objects and views.
    pub(super) fn of(kind: &KindScenes) -> Self {
        let first = kind.scenes.first();
        let n_objects = first.map_or(0, |scene| scene.n_objects);
        let sources = PredictionSource::ALL.into_iter().map(|source| {
            let of_scenes = kind.scenes.iter().flat_map(|scene| &scene.sources);
            let of_source = of_scenes.filter(|(of, _)| *of == source);
            let statistics: Vec<SourceStatistic> =
                of_source.map(|(_, statistic)| *statistic).collect();
            (source.word(), SourceReport::of(&statistics))
        });
        Self {
            kind: kind.kind,
            n_scenes: kind.scenes.len(),
            n_objects,
            n_views: first.map_or(0, |scene| scene.n_views),
            entropy_max: (n_objects.max(1) as f64).log2(),
            paper_sd: kind.paper.map(|paper| paper.sd),
            paper_mse: kind.paper.map(|paper| paper.mse),
            sources: sources.collect(),
        }
    }
}

impl SourceReport {
    fn of(scenes: &[SourceStatistic]) -> Self {
        let values =
            |value: fn(&SourceStatistic) -> f64| -> Vec<f64> { scenes.iter().map(value).collect() };
        let mean = |value| values(value).iter().sum::<f64>() / scenes.len().max(1) as f64;
        let scores: Vec<_> = scenes.iter().map(|scene| scene.score).collect();
        let deviation = |value| spread(&values(value));
        Self {
            statistic: SourceStatistic {
                best_ten_sd: mean(|scene| scene.best_ten_sd),
                best_ten_mse: mean(|scene| scene.best_ten_mse),
                score: PredictionScore::mean(&scores),
            },
            over_scenes: (scenes.len() > 1).then(|| Deviations {
                best_ten_sd: deviation(|scene| scene.best_ten_sd),
                best_ten_mse: deviation(|scene| scene.best_ten_mse),
                mae: deviation(|scene| scene.score.mae),
                regret: deviation(|scene| scene.score.regret),
            }),
        }
    }
}

/// Table of all kinds.
pub(super) fn table(kinds: &[KindReport]) -> ReportTable {
    let sources = kinds.iter().flat_map(|kind| {
        let names = PredictionSource::ALL
            .into_iter()
            .map(PredictionSource::word);
        names.filter_map(move |name| Some((kind, name, kind.sources.get(name)?)))
    });
    let with_deviation = |value: f64, deviation: Option<f64>| {
        let deviation = deviation.map_or(String::new(), |deviation| format!(" ± {deviation:.4}"));
        format!("{value:.4}{deviation}")
    };
    let paper = |value: Option<f64>| value.map_or("-".to_owned(), |value| value.to_string());
    ReportTable::of(
        "Published statistic",
        sources,
        &[
            ("scenes", &|(kind, ..)| {
                format!("{} × {}", kind.n_scenes, kind.kind)
            }),
            ("hypotheses", &|(_, name, _)| (*name).to_owned()),
            ("SD of the best ten, bit", &|(_, _, source)| {
                let deviation = source.over_scenes.map(|d| d.best_ten_sd);
                with_deviation(source.statistic.best_ten_sd, deviation)
            }),
            ("SD, paper", &|(kind, ..)| paper(kind.paper_sd)),
            ("MSE of the best ten, bit²", &|(_, _, source)| {
                let deviation = source.over_scenes.map(|d| d.best_ten_mse);
                with_deviation(source.statistic.best_ten_mse, deviation)
            }),
            ("MSE, paper", &|(kind, ..)| paper(kind.paper_mse)),
            ("MAE of all, bit", &|(_, _, source)| {
                with_deviation(
                    source.statistic.score.mae,
                    source.over_scenes.map(|d| d.mae),
                )
            }),
            ("bias bit", &|(.., source)| {
                format!("{:+.3}", source.statistic.score.bias)
            }),
            ("rank correlation", &|(.., source)| {
                number(source.statistic.score.spearman_rho, 3)
            }),
            ("regret bit (random)", &|(.., source)| {
                source.statistic.score.regrets()
            }),
            ("among the ten best %", &|(.., source)| {
                percent(source.statistic.score.top_ten_share)
            }),
        ],
    )
}

/// Notes about the statistic, one sentence each.
pub(super) fn notes(kinds: &[KindReport]) -> Vec<String> {
    let mut notes: Vec<String> = Vec::new();
    for kind in kinds {
        let KindReport {
            n_objects,
            n_views,
            n_scenes,
            entropy_max,
            ..
        } = kind;
        notes.push(format!(
            "published statistic, {}: {n_scenes} scenes of {n_objects} objects and {n_views} \
             views; no view can have more than {entropy_max:.2} bit",
            kind.kind
        ));
    }
    notes.push(
        "of the predictions of a view from all other views the ten with the smallest squared error \
         are kept, as the paper does for its figure 8: a choice by the answer, which says little \
         about a robot that does not know it; the errors over all pairs are the honest ones; ± is \
         the standard deviation over the scenes"
            .to_owned(),
    );
    let [cups, boxes] = TwinKind::ALL.map(unit_check);
    notes.push(format!(
        "the paper's MSE cannot be in the unit of its SD: about a mean near the truth the MSE is \
         nearly the square of the SD, but {cups}, and {boxes}"
    ));
    notes
}

/// Sentence about the unit of the paper's mean squared error.
fn unit_check(kind: TwinKind) -> String {
    let (PaperFigures { sd, mse }, n_objects) = (kind.paper(), kind.n_objects());
    let (rms, greatest) = (mse.sqrt(), (n_objects as f64).log2());
    format!(
        "{mse} beside {sd} would be a root mean square error of {rms:.2} bit, {:.0} % of the \
         greatest entropy of {n_objects} objects",
        100.0 * rms / greatest
    )
}

/// Box plots of the ten best predictions of each view, in the first scene of each kind; the views
/// are in the order of their true entropy.
pub(super) fn figure(kinds: &[KindScenes]) -> Result<String, DrawingError> {
    let panels: Vec<(String, Vec<BoxGroup>)> = kinds.iter().filter_map(panel).collect();
    let plot = |(title, groups)| BoxPlot {
        title,
        x_label: "view, by true entropy",
        y_label: "entropy, bit",
        names: ["true entropy", "ten best predictions from other views"],
        groups,
    };
    let plots: Vec<BoxPlot<'_>> = panels
        .iter()
        .map(|(title, groups)| plot((title.as_str(), groups.as_slice())))
        .collect();
    stacked(&plots)
}

fn panel(kind: &KindScenes) -> Option<(String, Vec<BoxGroup>)> {
    let scene = kind.scenes.first()?;
    let mut groups = scene.drawn.clone();
    groups.sort_by(|a, b| a.reference.total_cmp(&b.reference));
    let title = format!(
        "Entropy of the views of {} {}, hypotheses: {}",
        scene.n_objects,
        kind.kind,
        DRAWN.word()
    );
    Some((title, groups))
}
