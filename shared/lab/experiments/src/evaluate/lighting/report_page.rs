//! Text and HTML page of recognition under different lamps.

use super::report::{LightingReport, RoomFigures};
use command_line::format_table;
use plot::figure_page::{PageFigure, PageTable, html};
use plot::forest_plot::ForestPlotRow;
use statistics::bootstrap::Estimate;

/// Column headings of the table.
const HEADS: [&str; 5] = ["lighting", "table", "accuracy", "as seen", "shape only"];
/// File name of the figure.
pub(super) const PICTURE: &str = "accuracy.svg";
/// Caption of the figure.
pub(super) const CAPTION: &str = "Accuracy in each room with its 95 % interval";

/// Report as text for the terminal.
pub(super) fn text(document: &LightingReport) -> String {
    let mut lines = vec![format_table(&HEADS, &rows(document)), String::new()];
    lines.extend(notes(document));
    lines.join("\n")
}

/// HTML page with the table and the figure.
pub(super) fn page(document: &LightingReport) -> String {
    let table = PageTable::new("Rooms", &HEADS, rows(document));
    let figure = PageFigure {
        caption: CAPTION.to_owned(),
        picture: PICTURE.to_owned(),
    };
    html(
        "Recognition under other lamps",
        &notes(document),
        &[table],
        &[figure],
    )
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

fn rows(document: &LightingReport) -> Vec<Vec<String>> {
    let cell = |estimate: Option<Estimate>| {
        estimate.map_or_else(
            || "-".to_owned(),
            |estimate| format!("{:.3}", estimate.value),
        )
    };
    let row = |room: &RoomFigures| {
        vec![
            room.lighting.to_owned(),
            room.table.to_owned(),
            cell(room.accuracy),
            cell(room.as_seen),
            cell(room.shape_only),
        ]
    };
    document.rooms.iter().map(row).collect()
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
