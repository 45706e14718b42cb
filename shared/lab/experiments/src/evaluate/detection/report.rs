//! Report of the detection evaluation.

use super::scene_result::{PsiScores, SceneResult, SkippedScene};
use crate::arguments::DetectionArguments;
use crate::evaluate::report_parts::ReportFiles;
use constraint::Assumption;
use detection::Config;
use evaluation::segmentation_score::{HYPOTHESIS_PIXELS_MIN, SegmentationScore};
use serde::Serialize;
use statistics::percentiles::Percentiles;
use std::collections::BTreeMap;

/// Greatest spread of a steady scene's weighted overlap.
const STEADY_SPREAD_MAX: f64 = 0.01;

/// Report of a detection evaluation; scores are means over scenes, scenes are ordered worst first.
#[derive(Debug, Serialize)]
pub(super) struct DetectionReport<'a> {
    version: &'static str,
    dataset: String,
    pub(super) n_scenes: usize,
    overall: SegmentationScore,
    after_psi: SegmentationScore,
    pub(super) whole_objects: PsiScores,
    #[serde(skip)]
    pub(super) all: SceneGroup,
    pub(super) groups: BTreeMap<&'a str, SceneGroup>,
    pub(super) halves: Halves,
    /// `None` without draws.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) draws: Option<DrawSpreads>,
    pub(super) detection_ms: Percentiles,
    pub(super) ns_per_point: f64,
    pub(super) pass_over_cloud_ms: f64,
    pub(super) ratio_to_pass: f64,
    pub(super) per_scene: &'a [SceneResult],
    pub(super) skipped: &'a [SkippedScene],
    pub(super) settings: Settings,
    pub(super) assumptions: Vec<String>,
    #[serde(flatten)]
    pub(super) files: ReportFiles,
}

/// Settings of the detection evaluation.
#[derive(Debug, Serialize)]
pub(super) struct Settings {
    detection: &'static str,
    draws: u32,
    pub(super) repeats: u32,
    threads: u32,
    hypothesis_pixels_min: usize,
}

/// Scenes by the spread of their scores over draws.
#[derive(Debug, Serialize)]
pub(super) struct DrawSpreads {
    /// Number of scenes whose weighted overlap stays within one point when noise is drawn anew.
    pub(super) n_steady_with_noise: usize,
    /// Number of scenes whose weighted overlap stays within one point when the image is shifted.
    pub(super) n_steady_shifted: usize,
    /// Greatest spread of a scene over both.
    pub(super) spread_max: f64,
}

impl DrawSpreads {
    fn of(results: &[SceneResult]) -> Option<Self> {
        let draws = || results.iter().filter_map(|result| result.draws.as_ref());
        let is_steady = |spread: f64| spread <= STEADY_SPREAD_MAX;
        let spreads = draws().flat_map(|draws| [draws.noise.spread(), draws.shifted.spread()]);
        let of_noise = draws().filter(|draws| is_steady(draws.noise.spread()));
        let of_shift = draws().filter(|draws| is_steady(draws.shifted.spread()));
        Some(Self {
            n_steady_with_noise: of_noise.count(),
            n_steady_shifted: of_shift.count(),
            spread_max: spreads.max_by(f64::total_cmp)?,
        })
    }
}

/// Scenes split by the parity of the number in their name.
#[derive(Debug, Serialize)]
pub(super) struct Halves {
    pub(super) even: Option<SceneGroup>,
    pub(super) odd: Option<SceneGroup>,
}

/// Scores and timing of a group of scenes.
#[derive(Debug, Serialize)]
pub(super) struct SceneGroup {
    pub(super) n_scenes: usize,
    #[serde(flatten)]
    pub(super) scores: PsiScores,
    pub(super) whole_objects: PsiScores,
    pub(super) detection_ms: Percentiles,
}

/// Percentiles of a value over all repetitions of the scenes; `None` without values.
fn percentiles<'r>(
    results: impl IntoIterator<Item = &'r SceneResult>,
    values: impl Fn(&'r SceneResult) -> Vec<f64>,
) -> Option<Percentiles> {
    let values = results.into_iter().flat_map(values).collect();
    Percentiles::of(values)
}

impl SceneGroup {
    /// Group of the scenes that fulfil a predicate; `None` if there are none.
    fn of(results: &[SceneResult], is_wanted: impl Fn(&SceneResult) -> bool) -> Option<Self> {
        let wanted: Vec<&SceneResult> = results.iter().filter(|result| is_wanted(result)).collect();
        let whole_objects = wanted.iter().map(|result| &result.whole_objects);
        let detection_ms = |result: &SceneResult| result.durations_ms.clone();
        Some(Self {
            n_scenes: wanted.len(),
            scores: PsiScores::mean(wanted.iter().map(|result| &result.scores))?,
            whole_objects: PsiScores::mean(whole_objects)?,
            detection_ms: percentiles(wanted.iter().copied(), detection_ms)?,
        })
    }
}

impl<'a> DetectionReport<'a> {
    /// Report of results ordered worst first; `None` without results.
    pub(super) fn of(
        results: &'a [SceneResult],
        skipped: &'a [SkippedScene],
        arguments: &DetectionArguments,
    ) -> Option<Self> {
        let all = SceneGroup::of(results, |_| true)?;
        let groups = results.iter().map(|result| result.group.as_str());
        let groups = groups.filter_map(|group| {
            SceneGroup::of(results, |result| result.group == group).map(|part| (group, part))
        });
        let ns_per_point = |result: &SceneResult| {
            let n_points = result.n_points.max(1) as f64;
            let ns_per_point = |ms| ms * 1e6 / n_points;
            result.durations_ms.iter().map(ns_per_point).collect()
        };
        let pass_ms = percentiles(results, |result| result.pass_ms.clone())?.p50;
        Some(Self {
            version: env!("CARGO_PKG_VERSION"),
            dataset: arguments.dataset.display().to_string(),
            n_scenes: all.n_scenes,
            overall: all.scores.before_psi,
            after_psi: all.scores.after_psi,
            whole_objects: all.whole_objects,
            groups: groups.collect(),
            halves: Halves {
                even: SceneGroup::of(results, |result| !result.is_odd),
                odd: SceneGroup::of(results, |result| result.is_odd),
            },
            draws: DrawSpreads::of(results),
            detection_ms: all.detection_ms,
            ns_per_point: percentiles(results, ns_per_point)?.p50,
            pass_over_cloud_ms: pass_ms,
            ratio_to_pass: all.detection_ms.p50 / pass_ms,
            per_scene: results,
            skipped,
            settings: Settings {
                detection: "default",
                draws: arguments.draws,
                repeats: arguments.repeats,
                threads: 1,
                hypothesis_pixels_min: HYPOTHESIS_PIXELS_MIN,
            },
            assumptions: assumptions(results),
            all,
            files: ReportFiles::in_folder(&arguments.out, "detection.json"),
        })
    }
}

/// Assumptions of detection, one sentence each.
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
