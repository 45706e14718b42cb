//! Text and HTML page of the open-ended evaluation.

use super::report::{Figures, OpenEndedReport, RunFigures};
use crate::evaluate::open_set;
use command_line::format_table;
use plot::figure_page::{PageFigure, PageTable, html};

/// Column headings of the run table.
const HEADS: [&str; 7] = ["run", "qci", "tlc", "aic", "gca", "apa", "ended"];

/// Open-ended report as text for the terminal.
pub(super) fn text(document: &OpenEndedReport) -> String {
    let mut lines = vec![format_table(&HEADS, &rows(document)), String::new()];
    lines.extend(notes(document));
    lines.extend([document.files.page.clone(), document.files.file.clone()]);
    lines.join("\n")
}

/// HTML page with the figures of all runs.
pub(super) fn page(document: &OpenEndedReport) -> String {
    let table = PageTable::new("Runs", &HEADS, rows(document));
    let overview = PageFigure {
        caption: "All runs".to_owned(),
        picture: "overview.svg".to_owned(),
    };
    let runs = document.runs.iter().map(|run| PageFigure {
        caption: format!("run {}: {}", run.seed, cells(run)[1..].join(", ")),
        picture: run.picture.clone(),
    });
    let figures: Vec<PageFigure> = std::iter::once(overview).chain(runs).collect();
    html("Open-ended learning", &notes(document), &[table], &figures)
}

fn rows(document: &OpenEndedReport) -> Vec<Vec<String>> {
    let mut rows: Vec<Vec<String>> = document.runs.iter().map(cells).collect();
    rows.push(summary("mean", &document.mean));
    rows.push(summary("std", &document.std));
    rows
}

fn cells(run: &RunFigures) -> Vec<String> {
    let metrics = &run.metrics;
    let apa = metrics
        .apa
        .map_or("-".to_owned(), |apa| format!("{apa:.3}"));
    vec![
        run.seed.to_string(),
        metrics.qci.to_string(),
        metrics.tlc.to_string(),
        format!("{:.2}", metrics.aic),
        format!("{:.3}", metrics.gca),
        apa,
        run.stop.to_owned(),
    ]
}

fn summary(name: &str, figures: &Figures) -> Vec<String> {
    let value = |value: Option<f64>, digits: usize| {
        value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
    };
    vec![
        name.to_owned(),
        value(figures.qci, 1),
        value(figures.tlc, 2),
        value(figures.aic, 2),
        value(figures.gca, 3),
        value(figures.apa, 3),
        String::new(),
    ]
}

/// Notes below the table, one sentence each.
fn notes(document: &OpenEndedReport) -> Vec<String> {
    let settings = &document.settings;
    let mut notes = vec![
        format!(
            "{} categories, {} views; {}, protocol {}, accuracy {} to learn",
            document.header.n_categories,
            document.header.n_views,
            settings.description.text(),
            settings.protocol,
            settings.tau
        ),
        format!(
            "a view is described in {:.3} ms and compared in {:.3} ms on one thread, means",
            document.timing.describe_ms, document.timing.ask_ms
        ),
    ];
    notes.extend(document.open_set.as_ref().map(open_set::sentence));
    notes.extend(document.omissions.left_out.iter().cloned());
    notes
}
