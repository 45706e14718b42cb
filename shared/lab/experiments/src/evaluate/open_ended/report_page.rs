//! Table and figures of the open-ended evaluation.

use super::report::{Figures, OpenEndedReport, RunFigures};
use crate::evaluate::open_set;
use crate::evaluate::report_parts::OPEN_ENDED_LEGEND;
use crate::evaluate::tabular_report::{ReportTable, TabularReport, figure, number};

/// Table, notes and figures of the report.
pub(super) fn page(document: &OpenEndedReport) -> TabularReport<'static> {
    let runs = runs(document);
    let pictures = document.runs.iter().enumerate().map(|(row, run)| {
        let caption = format!("run {}: {}", run.seed, runs.joined(row, 1));
        figure(&run.picture, caption)
    });
    TabularReport {
        title: "Open-ended learning",
        figures: std::iter::once(figure("overview.svg", "All runs"))
            .chain(pictures)
            .collect(),
        tables: vec![runs.and(summary(document))],
        notes: notes(document),
        files: document.files.paths(),
        ..TabularReport::default()
    }
}

fn runs(document: &OpenEndedReport) -> ReportTable {
    ReportTable::of(
        "Runs",
        &document.runs,
        &[
            ("run", &|run: &&RunFigures| run.seed.to_string()),
            ("qci", &|run| run.metrics.qci.to_string()),
            ("tlc", &|run| run.metrics.tlc.to_string()),
            ("aic", &|run| number(run.metrics.aic, 2)),
            ("gca", &|run| number(run.metrics.gca, 3)),
            ("apa", &|run| number(run.metrics.apa, 3)),
            ("ended", &|run| run.stop.to_owned()),
        ],
    )
}

/// Mean and deviation of the runs, in the columns of the runs.
fn summary(document: &OpenEndedReport) -> ReportTable {
    ReportTable::of(
        "",
        [("mean", &document.mean), ("std", &document.std)],
        &[
            ("", &|(name, _): &(&str, &Figures)| (*name).to_owned()),
            ("", &|(_, figures)| number(figures.qci, 1)),
            ("", &|(_, figures)| number(figures.tlc, 2)),
            ("", &|(_, figures)| number(figures.aic, 2)),
            ("", &|(_, figures)| number(figures.gca, 3)),
            ("", &|(_, figures)| number(figures.apa, 3)),
            ("", &|_| String::new()),
        ],
    )
}

/// Notes below the table, one sentence each.
fn notes(document: &OpenEndedReport) -> Vec<String> {
    let settings = &document.settings;
    let mut notes = vec![
        OPEN_ENDED_LEGEND.to_owned(),
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
