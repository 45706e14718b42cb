//! The figures as a table or as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::figures::{Load, Run, median, quantile};

/// One figure of both systems.
pub struct Row {
    pub what: String,
    pub figure: &'static str,
    /// None when the store does not offer it.
    pub ours: Option<f64>,
    pub cpp: f64,
}

/// What the rows were measured on.
pub struct Disk {
    pub file_system: String,
    /// Median and 99th percentile of a 4 kB append with `fdatasync`.
    pub sync_ms: [f64; 2],
}

/// The rows of a scenario: medians of the turns, but the longest of all latencies.
pub fn rows_of_runs(what: &str, ours: &[Run], cpp: &[Run]) -> Vec<Row> {
    type Figure = (&'static str, fn(&[Run]) -> f64);
    let figures: [Figure; 5] = [
        ("per s", |runs| median(runs.iter().map(Run::per_second))),
        ("p50 ms", |runs| median(latencies_ms(runs, 0.5))),
        ("p99 ms", |runs| median(latencies_ms(runs, 0.99))),
        ("max ms", |runs| quantile(latencies_ms(runs, 1.0), 1.0)),
        ("bare ms", |runs| median(runs.iter().map(|run| run.sync_ms))),
    ];
    let row = |(figure, of): Figure| Row {
        what: what.to_owned(),
        figure,
        ours: (!ours.is_empty()).then(|| of(ours)),
        cpp: of(cpp),
    };
    figures.map(row).into()
}

fn latencies_ms(runs: &[Run], share: f64) -> impl Iterator<Item = f64> {
    runs.iter().map(move |run| run.latency_ms(share))
}

/// The rows of a loading: medians.
pub fn rows_of_loads(what: &str, ours: &[Load], cpp: &[Load]) -> Vec<Row> {
    type Figure = (&'static str, fn(&Load) -> f64);
    let figures: [Figure; 4] = [
        ("open ms", |load| load.opening_ms),
        ("all ms", |load| load.all_ms),
        ("RSS MB", |load| load.memory_kb / 1024.0),
        ("peak MB", |load| load.most_memory_kb / 1024.0),
    ];
    let row = |(figure, of): Figure| Row {
        what: what.to_owned(),
        figure,
        ours: Some(median(ours.iter().map(of))),
        cpp: median(cpp.iter().map(of)),
    };
    figures.map(row).into()
}

/// Each figure of ours, of C++ LevelDB, and the ratio.
pub fn table(disk: &Disk, rows: &[Row]) -> String {
    let [median, p99] = disk.sync_ms;
    let mut text = format!(
        "{}, fdatasync of 4 kB: {median:.2} ms, p99 {p99:.2} ms\n\n{:<38}{:<8}{:>10}{:>10}{:>8}\n",
        disk.file_system, "", "", "ours", "C++", "ratio"
    );
    let mut before = "";
    for row in rows {
        let what = if row.what == before { "" } else { &row.what };
        before = &row.what;
        let begin = if what.is_empty() { "" } else { "\n" };
        let _ = write!(text, "{begin}{what:<38}{:<8}", row.figure);
        let _ = match row.ours {
            Some(ours) => writeln!(text, "{ours:>10.2}{:>10.2}{:>8.2}", row.cpp, ours / row.cpp),
            None => writeln!(text, "{:>10}{:>10.2}", "-", row.cpp),
        };
    }
    text
}

/// The disk, and one object for each figure.
pub fn json(disk: &Disk, rows: &[Row]) -> Value {
    let object = |row: &Row| {
        json!({
            "what": row.what,
            "figure": row.figure,
            "ours": row.ours,
            "cpp_leveldb": row.cpp,
            "ratio": row.ours.map(|ours| ours / row.cpp),
        })
    };
    json!({
        "file_system": disk.file_system,
        "fdatasync_p50_ms": disk.sync_ms[0],
        "fdatasync_p99_ms": disk.sync_ms[1],
        "figures": rows.iter().map(object).collect::<Value>(),
    })
}
