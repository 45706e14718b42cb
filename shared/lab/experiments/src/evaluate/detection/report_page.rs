//! Tables and pictures of the detection evaluation.

use super::report::{DetectionReport, Halves, SceneGroup};
use super::scene_result::{SceneResult, SkippedScene};
use crate::evaluate::tabular_report::{ReportTable, TabularReport, figure, number, percent};
use evaluation::segmentation_score::{MEASURE_MEANINGS, MEASURE_NAMES, SegmentationScore};
use plot::figure_page::PageFigure;
use std::path::Path;

/// Number of worst scenes in the table. Chosen.
const N_WORST: usize = 5;
/// Number of skipped scenes named in the notes. Chosen.
const N_SKIPPED: usize = 10;
/// Note about the pictures.
const LEGEND: &str = "Scenes, worst first. Left: colour image; middle: ground truth; right: \
    result. A hypothesis has the colour of the object that it is matched with. Green: the table, \
    in the ground truth all labelled background. Striped: hypotheses rejected by ψ. Grey: \
    hypotheses too small to count. Dark: pixels without depth.";

/// Tables, notes and pictures of the report; `labels` is the folder of the written labels.
pub(super) fn page(
    document: &DetectionReport<'_>,
    labels: Option<&Path>,
) -> TabularReport<'static> {
    let mut notes = vec![measure_legend()];
    notes.extend(timing(document));
    notes.extend(left_out(document.skipped));
    let mut files = document.files.paths();
    files.extend(labels.map(|labels| labels.display().to_string()));
    let mut tables = score_tables(document);
    tables.push(worst(document));
    TabularReport {
        title: "Detection on labelled scenes",
        tables,
        notes,
        figures: document.per_scene.iter().map(picture).collect(),
        figure_note: Some(LEGEND),
        files,
    }
}

/// Legend of the measures: each name with its meaning.
fn measure_legend() -> String {
    let measures = MEASURE_NAMES.iter().zip(MEASURE_MEANINGS);
    let measures = measures.map(|(name, meaning)| format!("{name}: {meaning}"));
    measures.collect::<Vec<_>>().join("; ")
}

/// Score tables of the hypotheses before and after the object rule ψ: of parts apart, then of
/// whole objects.
fn score_tables(document: &DetectionReport<'_>) -> Vec<ReportTable> {
    let table = |title, score: fn(&SceneGroup) -> &SegmentationScore| {
        let rows = groups(document).into_iter().map(|(name, group)| {
            let names = [name.to_owned(), group.n_scenes.to_string()];
            row(names, score(group), group.detection_ms.p50)
        });
        ReportTable::new(title, heads(["%", "scenes"]), rows.collect())
    };
    vec![
        table("Parts before ψ", |group| &group.scores.before_psi),
        table("Parts after ψ", |group| &group.scores.after_psi),
        table("Whole objects before ψ", |group| {
            &group.whole_objects.before_psi
        }),
        table("Whole objects after ψ", |group| {
            &group.whole_objects.after_psi
        }),
    ]
}

/// All scenes, their groups and their halves, by name.
fn groups<'d>(document: &'d DetectionReport<'_>) -> Vec<(&'d str, &'d SceneGroup)> {
    let Halves { even, odd } = &document.halves;
    let groups = document.groups.iter().map(|(name, group)| (*name, group));
    let halves = [("even half", even), ("odd half", odd)].into_iter();
    let halves = halves.filter_map(|(name, half)| Some((name, half.as_ref()?)));
    std::iter::once(("all", &document.all))
        .chain(groups)
        .chain(halves)
        .collect()
}

fn worst(document: &DetectionReport<'_>) -> ReportTable {
    let rows = document.per_scene.iter().take(N_WORST).map(|scene| {
        let names = [scene.name.clone(), scene.group.clone()];
        row(names, &scene.scores.before_psi, scene.detection_ms.p50)
    });
    ReportTable::new("Worst scenes", heads(["worst", "group"]), rows.collect())
}

fn heads(names: [&'static str; 2]) -> Vec<&'static str> {
    let counts = ["hypotheses", "objects", "ms"];
    names
        .into_iter()
        .chain(MEASURE_NAMES)
        .chain(counts)
        .collect()
}

fn row(names: [String; 2], score: &SegmentationScore, ms: f64) -> Vec<String> {
    let counts = [score.n_hypotheses, score.n_objects].map(|n| n.to_string());
    let cells = names
        .into_iter()
        .chain(score.values().map(percent))
        .chain(counts);
    cells.chain([number(ms, 2)]).collect()
}

fn picture(scene: &SceneResult) -> PageFigure {
    let score = &scene.scores.before_psi;
    let measures = MEASURE_NAMES.iter().zip(score.values());
    let measures = measures.map(|(name, value)| format!("{name} {}", percent(value)));
    let caption = format!(
        "{} ({}): {}; {} hypotheses, {} objects; {:.2} ms",
        scene.name,
        scene.group,
        measures.collect::<Vec<_>>().join(" "),
        score.n_hypotheses,
        score.n_objects,
        scene.detection_ms.p50
    );
    figure(&scene.picture, caption)
}

/// Sentences about detection time and assumptions.
fn timing(document: &DetectionReport<'_>) -> Vec<String> {
    let duration = document.detection_ms;
    let mut sentences = vec![
        format!(
            "detection on one thread, {} times each scene: {:.2} ms (median), {:.2} ms (99 %)",
            document.settings.repeats, duration.p50, duration.p99
        ),
        format!(
            "{:.1} ns a point, {:.1} times a pass over the cloud ({:.3} ms)",
            document.ns_per_point, document.ratio_to_pass, document.pass_over_cloud_ms
        ),
    ];
    if let Some(draws) = &document.draws {
        sentences.push(format!(
            "WOv stays within a point in {} of {} scenes when noise is drawn anew, in {} when the \
             image is shifted; greatest spread {:.1} points",
            draws.n_steady_with_noise,
            document.n_scenes,
            draws.n_steady_shifted,
            100.0 * draws.spread_max
        ));
    }
    sentences.extend(document.assumptions.iter().cloned());
    sentences
}

/// Sentences about skipped scenes.
fn left_out(skipped: &[SkippedScene]) -> Vec<String> {
    let first = skipped.iter().take(N_SKIPPED);
    let sentence =
        |SkippedScene { name, reason }: &SkippedScene| format!("left out: {name}: {reason}");
    let mut sentences: Vec<String> = first.map(sentence).collect();
    if skipped.len() > N_SKIPPED {
        let n_more = skipped.len() - N_SKIPPED;
        sentences.push(format!(
            "left out: {n_more} more, which are in detection.json"
        ));
    }
    sentences
}
