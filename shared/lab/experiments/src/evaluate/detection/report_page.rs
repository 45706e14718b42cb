//! Text and HTML page of the detection evaluation.

use super::report::{DetectionReport, Halves, SceneGroup};
use super::scene_result::{SceneResult, SkippedScene};
use crate::arguments::DetectionArguments;
use command_line::format_table;
use evaluation::score_page::{PicturedScene, ScoreLine, ScoreTable, html};
use evaluation::segmentation_score::{MEASURE_NAMES, SegmentationScore};

/// Number of printed worst scenes. Chosen.
const N_WORST: usize = 5;
/// Number of skipped scenes named in the text. Chosen.
const N_SKIPPED: usize = 10;

/// Detection report as text for the terminal.
pub(super) fn text(document: &DetectionReport<'_>, arguments: &DetectionArguments) -> String {
    let mut lines = Vec::new();
    for scores in tables(document) {
        let rows = scores.lines.into_iter().map(|line| {
            let names = [line.name, line.n_scenes.to_string()];
            row(names, &line.score, line.detection_ms)
        });
        let rows: Vec<_> = rows.collect();
        let table = format_table(&heading(["%", "scenes"]), &rows);
        lines.extend([scores.title, table, String::new()]);
    }
    let worst = document.per_scene.iter().take(N_WORST);
    let worst = worst.map(|scene| {
        let names = [scene.name.into(), scene.group.into()];
        row(names, &scene.scores.before_psi, scene.detection_ms.p50)
    });
    let worst = format_table(&heading(["worst", "group"]), &worst.collect::<Vec<_>>());
    lines.extend([worst, String::new()]);
    lines.extend(timing(document));
    lines.extend(left_out(document.skipped));
    lines.extend([document.files.page.clone(), document.files.file.clone()]);
    let labels = arguments.labels.iter();
    lines.extend(labels.map(|labels| labels.display().to_string()));
    lines.join("\n")
}

fn heading(names: [&'static str; 2]) -> Vec<&'static str> {
    let counts = ["hypotheses", "objects", "ms"];
    let names = names.into_iter().chain(MEASURE_NAMES);
    names.chain(counts).collect()
}

fn row(names: [String; 2], score: &SegmentationScore, ms: f64) -> Vec<String> {
    let values = score.values();
    let values = values.iter().map(|value| format!("{:5.1}", 100.0 * value));
    let counts = [score.n_hypotheses, score.n_objects].map(|n| n.to_string());
    let cells = names.into_iter().chain(values).chain(counts);
    cells.chain([format!("{ms:.2}")]).collect()
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

/// HTML page of the detection report with all scenes.
pub(super) fn page(document: &DetectionReport<'_>, results: &[SceneResult]) -> String {
    let mut notes = timing(document);
    notes.extend(left_out(document.skipped));
    let scenes = results.iter().zip(&document.per_scene);
    let scenes = scenes.map(|(result, figures)| PicturedScene {
        name: result.name.clone(),
        group: result.group.clone(),
        score: result.scores.before_psi,
        detection_ms: figures.detection_ms.p50,
        picture: result.picture.clone(),
    });
    let scenes: Vec<_> = scenes.collect();
    html(
        "Detection on labelled scenes",
        &notes,
        &tables(document),
        &scenes,
    )
}

/// Score tables of the hypotheses before and after the object rule ψ: of the parts of objects
/// where these have labels of their own, then of whole objects.
fn tables(document: &DetectionReport<'_>) -> Vec<ScoreTable> {
    let has_parts = document.whole_objects.is_some();
    let kind = if has_parts { "Parts" } else { "Objects" };
    let table =
        |title: String, of_part: &dyn Fn(&SceneGroup) -> Option<SegmentationScore>| ScoreTable {
            title,
            lines: lines(document, of_part),
        };
    let mut tables = vec![
        table(format!("{kind} before ψ"), &|part| {
            Some(part.scores.before_psi)
        }),
        table(format!("{kind} after ψ"), &|part| {
            Some(part.scores.after_psi)
        }),
    ];
    if has_parts {
        tables.extend([
            table("Whole objects before ψ".to_owned(), &|part| {
                Some(part.whole_objects?.before_psi)
            }),
            table("Whole objects after ψ".to_owned(), &|part| {
                Some(part.whole_objects?.after_psi)
            }),
        ]);
    }
    tables
}

/// Table lines of the detection report: all scenes, groups, halves.
fn lines(
    document: &DetectionReport<'_>,
    score: &dyn Fn(&SceneGroup) -> Option<SegmentationScore>,
) -> Vec<ScoreLine> {
    let line = |(name, part): (&str, &SceneGroup)| {
        Some(ScoreLine {
            name: name.to_owned(),
            n_scenes: part.n_scenes,
            score: score(part)?,
            detection_ms: part.detection_ms.p50,
        })
    };
    let Halves { even, odd } = &document.halves;
    let groups = document.groups.iter().map(|(name, group)| (*name, group));
    let halves = [("even half", even), ("odd half", odd)];
    let halves = halves.into_iter();
    let halves = halves.filter_map(|(name, half)| Some((name, half.as_ref()?)));
    let all = std::iter::once(("all", &document.all));
    all.chain(groups).chain(halves).filter_map(line).collect()
}
