//! Text and HTML page of registration.

use super::report::{PairReport, RegistrationReport};
use super::trials::{ROTATIONS_DEG, TRANSLATIONS_CM};
use command_line::format_table;
use plot::figure_page::{PageFigure, PageTable, html};
use plot::forest_plot::ForestPlotRow;

/// Column headings of the table.
const HEADS: [&str; 6] = [
    "pair",
    "points",
    "success",
    "rotation °",
    "translation mm",
    "ms",
];
/// File name of the figure.
pub(super) const PICTURE: &str = "success.svg";
/// Caption of the figure.
pub(super) const CAPTION: &str = "Successful registrations of each pair with their 95 % interval";

/// Report as text for the terminal.
pub(super) fn text(document: &RegistrationReport) -> String {
    let mut lines = vec![format_table(&HEADS, &rows(document)), String::new()];
    lines.extend(notes(document));
    lines.join("\n")
}

/// HTML page with the table and the figure.
pub(super) fn page(document: &RegistrationReport) -> String {
    let table = PageTable::new("Pairs", &HEADS, rows(document));
    let figure = PageFigure {
        caption: CAPTION.to_owned(),
        picture: PICTURE.to_owned(),
    };
    html("Registration", &notes(document), &[table], &[figure])
}

/// Rows of the forest plot: one for each pair.
pub(super) fn figure_rows(document: &RegistrationReport) -> Vec<ForestPlotRow> {
    let row = |pair: &PairReport| ForestPlotRow {
        name: pair.name.clone(),
        estimate: pair.success,
        is_reference: false,
    };
    document.pairs.iter().map(row).collect()
}

fn rows(document: &RegistrationReport) -> Vec<Vec<String>> {
    let row = |pair: &PairReport| {
        vec![
            pair.name.clone(),
            format!("{} and {}", pair.n_target_points, pair.n_source_points),
            format!("{} of {}", pair.n_success, pair.n_trials),
            format!("{:.2}", pair.rotation_error_deg),
            format!("{:.2}", pair.translation_error_mm),
            format!("{:.1}", pair.ms),
        ]
    };
    document.pairs.iter().map(row).collect()
}

/// Notes below the table, one sentence each.
fn notes(document: &RegistrationReport) -> Vec<String> {
    let RegistrationReport { n_starts, seed, .. } = document;
    let directions = if *n_starts == 1 {
        "direction"
    } else {
        "directions"
    };
    let mut notes = vec![
        format!(
            "each source turned by {}° and moved by {} cm in {n_starts} random {directions}, and \
             registered again; seed {seed}",
            listed(&ROTATIONS_DEG),
            listed(&TRANSLATIONS_CM)
        ),
        "a success is less than 2° and 5 mm off; errors and times are medians".to_owned(),
    ];
    if let Some(angle_deg) = document.angle_deg {
        notes.push(format!("simulated views, {angle_deg}° apart"));
    }
    if let Some(success) = document.success {
        notes.push(format!(
            "mean success of the pairs {:.1} % ({:.1} to {:.1})",
            100.0 * success.value,
            100.0 * success.low,
            100.0 * success.high
        ));
    }
    notes
}

/// Numbers as words: "1, 3 and 5".
fn listed(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
    match words.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => words.concat(),
    }
}
