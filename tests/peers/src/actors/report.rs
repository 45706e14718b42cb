//! The figures as a table or as JSON.

use crate::measurement::Life;
use std::fmt::Write;

/// One system at one size.
pub struct Row {
    pub system: &'static str,
    pub n: usize,
    pub life: Life,
}

fn figures(life: &Life) -> [f64; 5] {
    [
        life.spawn_ns,
        life.first_ns,
        life.steady_ns,
        life.stop_ns,
        life.idle_bytes,
    ]
}

const NAMES: [&str; 5] = ["spawn ns", "first ns", "steady ns", "stop ns", "idle bytes"];

/// The bare task of the same size, which each block begins with.
fn bare<'a>(rows: &'a [Row], row: &Row) -> &'a Life {
    let same_size = rows.iter().find(|other| other.n == row.n);
    &same_size.expect("the row itself").life
}

/// For each figure its value and its ratio to the bare task's.
pub fn table(rows: &[Row]) -> String {
    let mut text = String::from("actors  system   ");
    for name in NAMES {
        let _ = write!(text, "  {name:>10}      ×");
    }
    for row in rows {
        let begin = if std::ptr::eq(bare(rows, row), &row.life) {
            "\n\n"
        } else {
            "\n"
        };
        let _ = write!(text, "{begin}{:>6}  {:<9}", row.n, row.system);
        for (figure, reference) in figures(&row.life).iter().zip(figures(bare(rows, row))) {
            let _ = write!(text, "  {figure:>10.0} {:>6.2}", figure / reference);
        }
    }
    text.push('\n');
    text
}

/// One object for each system and size.
pub fn json(rows: &[Row]) -> serde_json::Value {
    let object = |row: &Row| {
        serde_json::json!({
            "actors": row.n,
            "system": row.system,
            "spawn_ns": row.life.spawn_ns,
            "first_message_ns": row.life.first_ns,
            "steady_message_ns": row.life.steady_ns,
            "stop_ns": row.life.stop_ns,
            "idle_bytes": row.life.idle_bytes,
        })
    };
    rows.iter().map(object).collect()
}
