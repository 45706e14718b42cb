//! Table and figure of the ablation study.

use super::report::{AblationReport, VariantFigures};
use crate::evaluate::report_parts::OPEN_ENDED_LEGEND;
use crate::evaluate::tabular_report::{ReportTable, TabularReport, interval};
use plot::figure_page::PageFigure;
use plot::forest_plot::ForestPlotRow;

/// Table, notes and figure of the report.
pub(super) fn page(document: &AblationReport, figure: PageFigure) -> TabularReport<'static> {
    TabularReport {
        title: "Ablation",
        tables: vec![ReportTable::of(
            "Variants",
            &document.variants,
            &[
                ("variant", &|variant| variant.name.to_owned()),
                ("qci", &|variant| interval(variant.qci, 0)),
                ("tlc", &|variant| interval(variant.tlc, 1)),
                ("aic", &|variant| interval(variant.aic, 2)),
                ("gca", &|variant| interval(variant.gca, 3)),
                ("apa", &|variant| interval(variant.apa, 3)),
                ("gca − ours", &|variant| {
                    interval(variant.gca_difference, 3)
                }),
                ("error / ours", &|variant| interval(variant.error_ratio, 2)),
            ],
        )],
        notes: notes(document),
        figures: vec![figure],
        files: document.files.paths(),
        ..TabularReport::default()
    }
}

/// Rows of the forest plot, one for each variant.
pub(super) fn figure_rows(document: &AblationReport) -> Vec<ForestPlotRow> {
    let row = |variant: &VariantFigures| ForestPlotRow {
        name: variant.name.to_owned(),
        estimate: variant.gca,
        is_reference: variant.name == document.settings.reference,
    };
    document.variants.iter().map(row).collect()
}

/// Notes below the table, one sentence each.
fn notes(document: &AblationReport) -> Vec<String> {
    let settings = &document.settings;
    let mut notes = vec![
        OPEN_ENDED_LEGEND.to_owned(),
        format!(
            "{} categories, {} views; {} runs of each variant from the seeds {} to {}, protocol \
             {}, accuracy {} to learn",
            document.header.n_categories,
            document.header.n_views,
            settings.n_runs,
            settings.seed,
            settings.seed.wrapping_add(settings.n_runs - 1),
            settings.protocol,
            settings.tau
        ),
        format!(
            "means over the runs, and in brackets between which bounds they lie with 95 %, by {} \
             bootstrap resamples of the runs; the last two columns compare runs of the same seed",
            settings.n_resamples
        ),
    ];
    notes.extend(document.omissions.left_out.iter().cloned());
    notes
}
