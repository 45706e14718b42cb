//! Report of a demonstration over all its tables.

use super::run_record::{DemoKind, EventKind, RunRecord, RunSettings};
use crate::evaluate::tabular_report::{ReportTable, TabularReport, figure, number, percent};
use crate::output_files::write_figure;
use command_line::Output;
use plot::diagram::{Axis, Color, Curve, Diagram, Legend, in_columns};
use serde::Serialize;
use service::Failure;
use std::path::Path;
use std::process::ExitCode;

/// Document of a demonstration.
#[derive(Debug, Serialize)]
struct DemoReport<'r> {
    #[serde(flatten)]
    settings: &'r RunSettings,
    n_runs: usize,
    n_objects: usize,
    n_in_place: usize,
    /// Share of the objects that stand at the place of their category, by truth.
    cleared: f64,
    collisions: usize,
    standard_items_moved: usize,
    /// Number of the arm's motions that have failed, such as at a contact.
    stops: usize,
    /// Mean time from the instruction to the end of the task, seconds of the source.
    seconds: f64,
    /// Number of runs whose task has succeeded.
    n_succeeded: usize,
    /// Number of runs in which an absent object was asked for, and of those the ones that were refused
    /// with a sentence.
    n_absent: usize,
    n_absent_refused: usize,
    runs: &'r [RunRecord],
}

/// Writes the plots, the page and the document, and answers with the document or the text.
pub(super) fn publish(
    records: &[RunRecord],
    settings: &RunSettings,
    out: &Path,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let total = |count: fn(&RunRecord) -> usize| records.iter().map(count).sum::<usize>();
    let (n_objects, n_in_place) = (total(|run| run.n_objects), total(|run| run.n_in_place));
    let absent = || records.iter().filter(|run| run.n_objects == 0);
    let seconds: f64 = records.iter().map(|run| run.seconds).sum();
    let document = DemoReport {
        settings,
        n_runs: records.len(),
        n_objects,
        n_in_place,
        cleared: n_in_place as f64 / n_objects.max(1) as f64,
        collisions: total(|run| run.collisions.len()),
        standard_items_moved: total(|run| run.n_standard_moved),
        stops: total(|run| run.stops.len()),
        seconds: seconds / records.len().max(1) as f64,
        n_succeeded: records
            .iter()
            .filter(|run| run.phase == "succeeded")
            .count(),
        n_absent: absent().count(),
        n_absent_refused: absent().filter(|run| is_refused(run)).count(),
        runs: records,
    };
    let mut figures = Vec::new();
    let name = match settings.kind {
        DemoKind::ClearTable => "clear-table.json",
        DemoKind::Fetch => "fetch.json",
    };
    for run in records {
        let name = format!("seed-{}.svg", run.seed);
        write_figure(out, &name, recognition_figure(run))?;
        figures.push(figure(&name, format!("Recognition at table {}", run.seed)));
        let sheet = format!("seed-{}.png", run.seed);
        if out.join(&sheet).exists() {
            let captions = out.join(format!("seed-{}.txt", run.seed));
            let captions = std::fs::read_to_string(captions).unwrap_or_default();
            figures.push(figure(&sheet, captions.replace('\n', "; ")));
        }
    }
    let page = TabularReport {
        title: match settings.kind {
            DemoKind::ClearTable => "Clearing the table",
            DemoKind::Fetch => "Fetching an object",
        },
        tables: vec![runs_table(records), left_table(records)],
        notes: vec![format!(
            "cleared {} of {} objects ({} %), {} collisions, {} standard items moved",
            document.n_in_place,
            document.n_objects,
            percent(document.cleared),
            document.collisions,
            document.standard_items_moved
        )],
        figures,
        ..TabularReport::default()
    };
    page.publish(out, name, &document, output)
}

/// True if the robot has told that it cannot do what was asked, and has moved nothing.
fn is_refused(run: &RunRecord) -> bool {
    let is_failed = run.phase == "failed" && !run.sentence.is_empty();
    (run.refusal.is_some() || is_failed) && run.collisions.is_empty()
}

fn runs_table(records: &[RunRecord]) -> ReportTable {
    ReportTable::of(
        "Tables",
        records,
        &[
            ("seed", &|run| run.seed.to_string()),
            ("objects", &|run| run.n_objects.to_string()),
            ("in place", &|run| run.n_in_place.to_string()),
            ("collisions", &|run| run.collisions.len().to_string()),
            ("standard moved", &|run| run.n_standard_moved.to_string()),
            ("stops", &|run| run.stops.len().to_string()),
            ("seconds", &|run| number(run.seconds, 1)),
            ("taught", &|run| run.n_taught.to_string()),
            ("corrected", &|run| run.n_corrected.to_string()),
            ("precision", &|run| number(run.precision, 3)),
            ("recall", &|run| number(run.recall, 3)),
            ("task", &|run| {
                let refused = run.refusal.as_ref().map(|_| "refused".to_owned());
                refused.unwrap_or_else(|| run.phase.clone())
            }),
        ],
    )
}

/// Table of what was left.
fn left_table(records: &[RunRecord]) -> ReportTable {
    let is_left = |run: &&RunRecord| run.n_in_place < run.n_objects;
    ReportTable::of(
        "Tables with objects that are not in place",
        records.iter().filter(is_left),
        &[
            ("seed", &|run| run.seed.to_string()),
            ("not in place", &|run| {
                let left = run.objects.iter();
                let left = left.filter(|object| !object.is_in_place && object.is_wanted);
                let names: Vec<&str> = left.map(|object| object.category.as_str()).collect();
                names.join(", ")
            }),
            ("report", &|run| run.sentence.clone()),
        ],
    )
}

/// Precision and recall over the last 15 results, with the events of the run (Kasaei et al. 2018,
/// Fig. 7).
fn recognition_figure(run: &RunRecord) -> Result<String, plot::DrawingError> {
    let end_s = run.scores.last().map_or(1.0, |point| point.time_s).max(1.0);
    let curve = |name, color, of: fn(&super::recognition_score::ScorePoint) -> Option<f64>| {
        let points = run.scores.iter();
        let points = points.filter_map(|point| Some((point.time_s, of(point)?)));
        Curve::line(name, color, points)
    };
    let marks = |name, kind: EventKind, color| {
        let events = run.events.iter().filter(|event| event.kind == kind);
        // One line that goes up and down again at each event, below the curves.
        let points = events.flat_map(|event| {
            let at_s = event.time_s;
            [(at_s, -0.15), (at_s, -0.02), (at_s, -0.15)]
        });
        Curve::line(name, color, points)
    };
    let title = format!("Recognition at table {}, over 15 results", run.seed);
    let diagram = Diagram {
        title: &title,
        x: Axis::linear("time, s", 0.0..end_s),
        y: Axis::linear("share", -0.15..1.05),
        curves: vec![
            marks("taught", EventKind::Taught, Color(0, 150, 0)),
            marks("grasped", EventKind::Grasped, Color(230, 120, 0)),
            marks("track ended", EventKind::TrackEnded, Color::GREY),
            curve("precision", Color::BLUE, |point| point.precision),
            curve("recall", Color::RED, |point| point.recall),
        ],
        legend: Legend::Outside,
    };
    in_columns(&[diagram], 1)
}
