//! Table and figure of registration.

use super::report::{PairReport, RegistrationReport};
use super::trials::{ROTATIONS_DEG, TRANSLATIONS_CM};
use crate::evaluate::tabular_report::{ReportTable, TabularReport, number};
use plot::forest_plot::ForestPlotRow;

/// Table, notes and figure of the report.
pub(super) fn page(document: &RegistrationReport) -> TabularReport<'static> {
    let of = |n: usize, word: &str, m: usize| format!("{n} {word} {m}");
    TabularReport {
        title: "Registration",
        tables: vec![ReportTable::of(
            "Pairs",
            &document.pairs,
            &[
                ("pair", &|pair| pair.name.clone()),
                ("points", &|pair| {
                    of(pair.n_target_points, "and", pair.n_source_points)
                }),
                ("success", &|pair| of(pair.n_success, "of", pair.n_trials)),
                ("rotation °", &|pair| number(pair.rotation_error_deg, 2)),
                ("translation mm", &|pair| {
                    number(pair.translation_error_mm, 2)
                }),
                ("ms", &|pair| number(pair.ms, 1)),
            ],
        )],
        notes: notes(document),
        ..TabularReport::default()
    }
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
