//! Report of the actor benchmark as a text table or as JSON.

use crate::lifecycle::LifecycleCosts;
use std::fmt::Write;

/// Median costs of one system at one group size.
pub struct Row {
    pub system: &'static str,
    pub n: usize,
    pub costs: LifecycleCosts,
}

/// Costs in the order of [`NAMES`].
fn figures(costs: &LifecycleCosts) -> [f64; 5] {
    [
        costs.spawn_ns,
        costs.first_ns,
        costs.steady_ns,
        costs.stop_ns,
        costs.idle_bytes,
    ]
}

/// Column names of the costs.
const NAMES: [&str; 5] = ["spawn ns", "first ns", "steady ns", "stop ns", "idle bytes"];

/// Baseline of the ratios: the first row of the same size, which is the bare task.
fn baseline<'a>(rows: &'a [Row], row: &Row) -> &'a LifecycleCosts {
    let same_size = rows.iter().find(|other| other.n == row.n);
    &same_size.expect("the row itself").costs
}

/// Text table of each cost and its ratio to the baseline.
pub fn table(rows: &[Row]) -> String {
    let mut text = String::from("actors  system   ");
    for name in NAMES {
        let _ = write!(text, "  {name:>10}      ×");
    }
    for row in rows {
        let begin = if std::ptr::eq(baseline(rows, row), &row.costs) {
            "\n\n"
        } else {
            "\n"
        };
        let _ = write!(text, "{begin}{:>6}  {:<9}", row.n, row.system);
        for (figure, reference) in figures(&row.costs).iter().zip(figures(baseline(rows, row))) {
            let _ = write!(text, "  {figure:>10.0} {:>6.2}", figure / reference);
        }
    }
    text.push('\n');
    text
}

/// JSON array with one object per system and size.
pub fn json(rows: &[Row]) -> serde_json::Value {
    let object = |row: &Row| {
        serde_json::json!({
            "actors": row.n,
            "system": row.system,
            "spawn_ns": row.costs.spawn_ns,
            "first_message_ns": row.costs.first_ns,
            "steady_message_ns": row.costs.steady_ns,
            "stop_ns": row.costs.stop_ns,
            "idle_bytes": row.costs.idle_bytes,
        })
    };
    rows.iter().map(object).collect()
}
