//! Text and HTML page of the ablation study.

use super::report::{AblationReport, VariantFigures};
use command_line::format_table;
use plot::figure_page::{PageFigure, PageTable, html};
use plot::forest_plot::ForestPlotRow;
use statistics::bootstrap::Estimate;

/// Column headings of the ablation table.
const HEADS: [&str; 8] = [
    "variant",
    "qci",
    "tlc",
    "aic",
    "gca",
    "apa",
    "gca − ours",
    "error / ours",
];
/// File name of the GCA figure.
pub(super) const PICTURE: &str = "gca.svg";
/// Caption of the ablation figure.
pub(super) const CAPTION: &str = "Mean GCA of each variant with its 95 % interval";

/// Ablation report as text for the terminal.
pub(super) fn text(document: &AblationReport) -> String {
    let mut lines = vec![format_table(&HEADS, &rows(document)), String::new()];
    lines.extend(notes(document));
    lines.extend([document.files.page.clone(), document.files.file.clone()]);
    lines.join("\n")
}

/// HTML page with the ablation table and figure.
pub(super) fn page(document: &AblationReport) -> String {
    let table = PageTable::new("Variants", &HEADS, rows(document));
    let figure = PageFigure {
        caption: CAPTION.to_owned(),
        picture: PICTURE.to_owned(),
    };
    html("Ablation", &notes(document), &[table], &[figure])
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

fn rows(document: &AblationReport) -> Vec<Vec<String>> {
    let row = |variant: &VariantFigures| {
        vec![
            variant.name.to_owned(),
            cell(variant.qci, 0),
            cell(variant.tlc, 1),
            cell(variant.aic, 2),
            cell(variant.gca, 3),
            cell(variant.apa, 3),
            cell(variant.gca_difference, 3),
            cell(variant.error_ratio, 2),
        ]
    };
    document.variants.iter().map(row).collect()
}

/// Table cell of an interval: `0.712 (0.690 to 0.731)`.
fn cell(interval: Option<Estimate>, digits: usize) -> String {
    interval.map_or(String::new(), |Estimate { value, low, high }| {
        format!("{value:.digits$} ({low:.digits$} to {high:.digits$})")
    })
}

/// Notes below the table, one sentence each.
fn notes(document: &AblationReport) -> Vec<String> {
    let settings = &document.settings;
    let mut notes = vec![
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
