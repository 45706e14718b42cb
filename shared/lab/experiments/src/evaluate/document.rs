//! The figures of `tabula evaluate detection` as a document.

use super::detection::{SceneResult, Skipped};
use crate::arguments::DetectionArguments;
use constraint::Assumption;
use detection::Config;
use evaluation::segmentation_score::{HYPOTHESIS_PIXELS_MIN, SegmentationScore};
use serde::Serialize;
use statistics::percentiles::Percentiles;
use std::collections::BTreeMap;

/// All figures; scores are means over scenes, worst scene first.
#[derive(Debug, Serialize)]
pub(super) struct Document<'a> {
    version: &'static str,
    dataset: String,
    pub(super) n_scenes: usize,
    pub(super) overall: Scores,
    pub(super) after_psi: Scores,
    pub(super) groups: BTreeMap<&'a str, Part>,
    pub(super) halves: Halves,
    pub(super) detection_ms: Duration,
    pub(super) ns_per_point: f64,
    pub(super) pass_over_cloud_ms: f64,
    pub(super) ratio_to_pass: f64,
    pub(super) per_scene: Vec<SceneFigures<'a>>,
    pub(super) skipped: &'a [Skipped],
    pub(super) settings: Settings,
    pub(super) assumptions: Vec<String>,
    pub(super) page: String,
    pub(super) file: String,
}

/// How the figures were made.
#[derive(Debug, Serialize)]
pub(super) struct Settings {
    detection: &'static str,
    seed: u64,
    pub(super) repeats: u32,
    threads: u32,
    hypothesis_pixels_min: usize,
}

/// Scenes by the number they end in.
#[derive(Debug, Serialize)]
pub(super) struct Halves {
    pub(super) even: Option<Part>,
    pub(super) odd: Option<Part>,
}

/// Some of the scenes.
#[derive(Debug, Serialize)]
pub(super) struct Part {
    pub(super) n_scenes: usize,
    #[serde(flatten)]
    pub(super) scores: Scores,
    pub(super) after_psi: Scores,
    pub(super) detection_ms: Duration,
}

/// One scene.
#[derive(Debug, Serialize)]
pub(super) struct SceneFigures<'a> {
    pub(super) name: &'a str,
    pub(super) group: &'a str,
    n_points: usize,
    #[serde(flatten)]
    pub(super) scores: Scores,
    after_psi: Scores,
    pub(super) detection_ms: Duration,
    picture: &'a str,
}

/// Percentiles of durations, milliseconds.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Duration {
    pub(super) p50: f64,
    pub(super) p99: f64,
}

/// Scores as fractions.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Scores {
    n_objects: usize,
    n_hypotheses: usize,
    wov: f64,
    uov: f64,
    fos: f64,
    fus: f64,
    p50: f64,
    r50: f64,
    f50: f64,
    o_p: f64,
    o_r: f64,
    o_f: f64,
    f75: f64,
    #[serde(skip)]
    pub(super) score: SegmentationScore,
}

impl From<SegmentationScore> for Scores {
    fn from(score: SegmentationScore) -> Self {
        let [wov, uov, fos, fus, p50, r50, f50, o_p, o_r, o_f, f75] = score.values();
        Self {
            n_objects: score.n_objects,
            n_hypotheses: score.n_hypotheses,
            wov,
            uov,
            fos,
            fus,
            p50,
            r50,
            f50,
            o_p,
            o_r,
            o_f,
            f75,
            score,
        }
    }
}

/// Percentiles of a figure of all scenes' repeats; `None` without any.
fn percentiles<'r>(
    results: impl IntoIterator<Item = &'r SceneResult>,
    values: impl Fn(&'r SceneResult) -> Vec<f64>,
) -> Option<Duration> {
    let values = results.into_iter().flat_map(values).collect();
    Percentiles::of(values).map(|Percentiles { p50, p99 }| Duration { p50, p99 })
}

impl Part {
    /// Of the scenes that are wanted; `None` when there are none.
    fn of(results: &[SceneResult], is_wanted: impl Fn(&SceneResult) -> bool) -> Option<Self> {
        let wanted: Vec<&SceneResult> = results.iter().filter(|result| is_wanted(result)).collect();
        let mean = |score: fn(&SceneResult) -> &SegmentationScore| {
            SegmentationScore::mean(wanted.iter().map(|result| score(result)))
        };
        let detection_ms = |result: &SceneResult| result.detection_ms.clone();
        Some(Self {
            n_scenes: wanted.len(),
            scores: mean(|result| &result.before_psi)?.into(),
            after_psi: mean(|result| &result.after_psi)?.into(),
            detection_ms: percentiles(wanted.iter().copied(), detection_ms)?,
        })
    }
}

impl<'a> SceneFigures<'a> {
    fn of(result: &'a SceneResult) -> Option<Self> {
        let detection_ms = |result: &SceneResult| result.detection_ms.clone();
        Some(Self {
            name: &result.name,
            group: &result.group,
            n_points: result.n_points,
            scores: result.before_psi.into(),
            after_psi: result.after_psi.into(),
            detection_ms: percentiles([result], detection_ms)?,
            picture: &result.picture,
        })
    }
}

impl<'a> Document<'a> {
    /// Of results, worst first; `None` without any.
    pub(super) fn of(
        results: &'a [SceneResult],
        skipped: &'a [Skipped],
        arguments: &DetectionArguments,
    ) -> Option<Self> {
        let all = Part::of(results, |_| true)?;
        let groups = results.iter().map(|result| result.group.as_str());
        let groups = groups.filter_map(|group| {
            Part::of(results, |result| result.group == group).map(|part| (group, part))
        });
        let ns_per_point = |result: &SceneResult| {
            let n_points = result.n_points.max(1) as f64;
            let ns_per_point = |ms| ms * 1e6 / n_points;
            result.detection_ms.iter().map(ns_per_point).collect()
        };
        let pass_ms = percentiles(results, |result| result.pass_ms.clone())?.p50;
        Some(Self {
            version: env!("CARGO_PKG_VERSION"),
            dataset: arguments.dataset.display().to_string(),
            n_scenes: all.n_scenes,
            overall: all.scores,
            after_psi: all.after_psi,
            groups: groups.collect(),
            halves: Halves {
                even: Part::of(results, |result| !result.is_odd),
                odd: Part::of(results, |result| result.is_odd),
            },
            detection_ms: all.detection_ms,
            ns_per_point: percentiles(results, ns_per_point)?.p50,
            pass_over_cloud_ms: pass_ms,
            ratio_to_pass: all.detection_ms.p50 / pass_ms,
            per_scene: results.iter().filter_map(SceneFigures::of).collect(),
            skipped,
            settings: Settings {
                detection: "default",
                seed: arguments.seed,
                repeats: arguments.repeats,
                threads: 1,
                hypothesis_pixels_min: HYPOTHESIS_PIXELS_MIN,
            },
            assumptions: assumptions(results),
            page: arguments.out.join("index.html").display().to_string(),
            file: arguments.out.join("detection.json").display().to_string(),
        })
    }
}

/// What was taken to be so.
fn assumptions(results: &[SceneResult]) -> Vec<String> {
    let n_with_up = results.iter().filter(|result| result.has_up).count();
    let known = format!("up is known in {n_with_up} of {} scenes", results.len());
    let rule = format!("ψ: {}", Config::default().rule());
    let assumed = Assumption::ALL.into_iter().filter(|&assumption| {
        let mut assumed = results.iter().map(|result| result.assumptions);
        assumed.any(|assumptions| assumptions.contains(assumption))
    });
    let assumed = assumed.map(|assumption| assumption.sentence().to_owned());
    [known, rule].into_iter().chain(assumed).collect()
}
