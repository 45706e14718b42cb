//! Report of an ageing: table, JSON document, and plots against the number of changes.

use super::opening::Opening;
use crate::output_files::{write, write_figure};
use command_line::format_table;
use plot::diagram::{Axis, Color, Curve, Diagram, DrawingError, Legend, side_by_side};
use serde::Serialize;
use service::Failure;
use std::path::Path;

/// Rows of an ageing, by number of changes.
#[derive(Debug, Default, Serialize)]
pub(super) struct AgeingReport {
    rows: Vec<AgeingRow>,
}

/// State and opening of the store after a number of changes.
#[derive(Debug, Serialize)]
pub(super) struct AgeingRow {
    /// Number of changes requested so far.
    pub(super) n_changes: u64,
    pub(super) simulated_days: f64,
    /// Time that the changes took so far, seconds.
    pub(super) ageing_s: f64,
    /// Size of all files of the store, megabytes.
    pub(super) disk_mb: f64,
    #[serde(flatten)]
    pub(super) opening: Opening,
}

impl AgeingReport {
    pub(super) fn push(&mut self, row: AgeingRow) {
        self.rows.push(row);
    }

    /// Writes `ageing.json` and `ageing.svg`.
    pub(super) fn write(&self, out: &Path) -> Result<(), Failure> {
        let json = serde_json::to_vec_pretty(self).map_err(Failure::general)?;
        write(&out.join("ageing.json"), &json)?;
        write_figure(out, "ageing.svg", self.figure())
    }

    pub(super) fn text(&self) -> String {
        let heading = [
            "changes", "days", "views", "notes", "open s", "peak MB", "disk MB", "aged s",
        ];
        let row = |row: &AgeingRow| {
            vec![
                row.n_changes.to_string(),
                format!("{:.0}", row.simulated_days),
                row.opening.n_views.to_string(),
                row.opening.n_tombstones.to_string(),
                format!("{:.3}", row.opening.opening_s),
                format!("{:.0}", row.opening.peak_rss_mb),
                format!("{:.0}", row.disk_mb),
                format!("{:.0}", row.ageing_s),
            ]
        };
        format_table(&heading, &self.rows.iter().map(row).collect::<Vec<_>>())
    }

    /// Opening time, peak memory and disk space against the number of changes.
    fn figure(&self) -> Result<String, DrawingError> {
        let diagrams = [
            self.diagram("Opening time", "s", |row| row.opening.opening_s),
            self.diagram("Peak memory of the opening", "MB", |row| {
                row.opening.peak_rss_mb
            }),
            self.diagram("Disk space", "MB", |row| row.disk_mb),
        ];
        side_by_side(&diagrams)
    }

    fn diagram<'a>(
        &self,
        title: &'a str,
        unit: &'a str,
        value: impl Fn(&AgeingRow) -> f64,
    ) -> Diagram<'a> {
        let points = self
            .rows
            .iter()
            .map(|row| (row.n_changes as f64, value(row)));
        let points: Vec<(f64, f64)> = points.collect();
        let largest = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).fold(1e-3, f64::max);
        let (n_most, most) = (largest(|point| point.0), largest(|point| point.1));
        Diagram {
            title,
            x: Axis::linear("changes made", 0.0..1.05 * n_most),
            y: Axis::linear(unit, 0.0..1.1 * most),
            curves: vec![Curve::marked(title, Color::BLUE, points)],
            legend: Legend::LowerLeft,
        }
    }
}
