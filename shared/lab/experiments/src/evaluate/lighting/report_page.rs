//! Table and figure of recognition under different lamps.

use super::report::{LightingReport, RoomFigures};
use crate::evaluate::tabular_report::{ReportTable, TabularReport, number};
use plot::figure_page::PageFigure;
use plot::forest_plot::ForestPlotRow;
use statistics::bootstrap::Estimate;

/// Table, notes and figure of the report.
pub(super) fn page(document: &LightingReport, figure: PageFigure) -> TabularReport<'static> {
    let mean = |estimate: Option<Estimate>| number(estimate.map(|estimate| estimate.value), 3);
    TabularReport {
        title: "Recognition under other lamps",
        tables: vec![ReportTable::of(
            "Rooms",
            &document.rooms,
            &[
                ("lighting", &|room| room.lighting.to_owned()),
                ("table", &|room| room.table.to_owned()),
                ("accuracy", &|room| mean(room.accuracy)),
                ("as seen", &|room| mean(room.as_seen)),
                ("shape only", &|room| mean(room.shape_only)),
            ],
        )],
        notes: notes(document),
        figures: vec![figure],
        ..TabularReport::default()
    }
}

/// Rows of the forest plot: two for each room, with and without white balance.
pub(super) fn figure_rows(document: &LightingReport) -> Vec<ForestPlotRow> {
    let rows = |(number, room): (usize, &RoomFigures)| {
        let row = |suffix: &str, estimate, is_reference| ForestPlotRow {
            name: format!("{}, {}{suffix}", room.lighting, room.table),
            estimate,
            is_reference,
        };
        [
            row("", room.accuracy, number == 0),
            row(" (as seen)", room.as_seen, false),
        ]
    };
    document.rooms.iter().enumerate().flat_map(rows).collect()
}

/// Notes below the table, one sentence each.
fn notes(document: &LightingReport) -> Vec<String> {
    let LightingReport {
        n_objects,
        n_views,
        seed,
        ..
    } = document;
    let mut notes = vec![format!(
        "{n_objects} objects, each taught as itself from {n_views} views under the white lamp on \
         the oak table, and recognised from single views between them; seed {seed}"
    )];
    if let (Some(loss), Some(as_seen)) = (document.worst_loss, document.worst_loss_as_seen) {
        notes.push(format!(
            "greatest loss against the white lamp beside the same table: {:.1} points, without \
             white balance {:.1} points",
            100.0 * loss,
            100.0 * as_seen
        ));
    }
    notes
}
