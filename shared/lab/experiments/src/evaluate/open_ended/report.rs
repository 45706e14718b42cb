//! The figures of `tabula evaluate open-ended` for people.

use super::super::open_set::OpenSet;
use super::document::{Document, Figures, RunFigures};
use command_line::format_table;
use plot::figure_page::{PageFigure, PageTable, html};

/// Heads of the columns.
const HEADS: [&str; 7] = ["run", "qci", "tlc", "aic", "gca", "apa", "ended"];

/// The text that is printed.
pub(super) fn text(document: &Document) -> String {
    let mut lines = vec![format_table(&HEADS, &rows(document)), String::new()];
    lines.extend(notes(document));
    lines.extend([document.page.clone(), document.file.clone()]);
    lines.join("\n")
}

/// The page with the figures of all runs.
pub(super) fn page(document: &Document) -> String {
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

fn rows(document: &Document) -> Vec<Vec<String>> {
    let mut rows: Vec<Vec<String>> = document.runs.iter().map(cells).collect();
    rows.push(summary("mean", &document.mean));
    rows.push(summary("std", &document.std));
    rows
}

fn cells(run: &RunFigures) -> Vec<String> {
    let apa = run.apa.map_or("-".to_owned(), |apa| format!("{apa:.3}"));
    vec![
        run.seed.to_string(),
        run.qci.to_string(),
        run.tlc.to_string(),
        format!("{:.2}", run.aic),
        format!("{:.3}", run.gca),
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

/// What else is said, one sentence each.
fn notes(document: &Document) -> Vec<String> {
    let settings = &document.settings;
    let mut notes = vec![
        format!(
            "{} categories, {} views; {}, protocol {}, accuracy {} to learn",
            document.n_categories,
            document.n_views,
            settings.description.text(),
            settings.protocol,
            settings.tau
        ),
        format!(
            "a view is described in {:.3} ms and compared in {:.3} ms on one thread, means",
            document.timing.describe_ms, document.timing.ask_ms
        ),
    ];
    notes.extend(document.open_set.as_ref().map(OpenSet::sentence));
    notes.extend(document.left_out.iter().cloned());
    notes
}
