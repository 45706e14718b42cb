//! Report of the store benchmark as a text table or as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::timing::{LoadTiming, MutationTiming, median, quantile};

/// One figure of both stores.
pub struct FigureRow {
    /// Name of the scenario.
    pub scenario: String,
    /// Name and unit of the figure.
    pub figure: &'static str,
    /// Value of the store of tabula; `None` if it does not support the scenario.
    pub ours: Option<f64>,
    /// Value of C++ LevelDB.
    pub cpp: f64,
}

/// Disk on which the figures were measured.
pub struct DiskProfile {
    /// Type of the file system.
    pub file_system: String,
    /// Median and 99th percentile of a 4 kB append with `fdatasync`, milliseconds.
    pub sync_ms: [f64; 2],
}

/// Rows of a scenario: medians over the rounds, and the maximum of all latencies.
pub fn mutation_rows(
    scenario: &str,
    ours: &[MutationTiming],
    cpp: &[MutationTiming],
) -> Vec<FigureRow> {
    type Figure = (&'static str, fn(&[MutationTiming]) -> f64);
    let figures: [Figure; 5] = [
        ("per s", |runs| {
            median(runs.iter().map(MutationTiming::per_second))
        }),
        ("p50 ms", |runs| median(latencies_ms(runs, 0.5))),
        ("p99 ms", |runs| median(latencies_ms(runs, 0.99))),
        ("max ms", |runs| quantile(latencies_ms(runs, 1.0), 1.0)),
        ("bare ms", |runs| median(runs.iter().map(|run| run.sync_ms))),
    ];
    let row = |(figure, of): Figure| FigureRow {
        scenario: scenario.to_owned(),
        figure,
        ours: (!ours.is_empty()).then(|| of(ours)),
        cpp: of(cpp),
    };
    figures.map(row).into()
}

/// Quantile of the latency of each run at `share`, milliseconds.
fn latencies_ms(runs: &[MutationTiming], share: f64) -> impl Iterator<Item = f64> {
    runs.iter().map(move |run| run.latency_ms(share))
}

/// Rows of the loading benchmark: medians over the runs.
pub fn load_rows(scenario: &str, ours: &[LoadTiming], cpp: &[LoadTiming]) -> Vec<FigureRow> {
    type Figure = (&'static str, fn(&LoadTiming) -> f64);
    let figures: [Figure; 4] = [
        ("open ms", |load| load.opening_ms),
        ("all ms", |load| load.total_ms),
        ("RSS MB", |load| load.memory_kb / 1024.0),
        ("peak MB", |load| load.peak_memory_kb / 1024.0),
    ];
    let row = |(figure, of): Figure| FigureRow {
        scenario: scenario.to_owned(),
        figure,
        ours: Some(median(ours.iter().map(of))),
        cpp: median(cpp.iter().map(of)),
    };
    figures.map(row).into()
}

/// Text table of each figure of both stores and their ratio.
pub fn table(disk: &DiskProfile, rows: &[FigureRow]) -> String {
    let [median, p99] = disk.sync_ms;
    let mut text = format!(
        "{}, fdatasync of 4 kB: {median:.2} ms, p99 {p99:.2} ms\n\n{:<38}{:<8}{:>10}{:>10}{:>8}\n",
        disk.file_system, "", "", "ours", "C++", "ratio"
    );
    let mut before = "";
    for row in rows {
        let scenario = if row.scenario == before {
            ""
        } else {
            &row.scenario
        };
        before = &row.scenario;
        let begin = if scenario.is_empty() { "" } else { "\n" };
        let _ = write!(text, "{begin}{scenario:<38}{:<8}", row.figure);
        let _ = match row.ours {
            Some(ours) => writeln!(text, "{ours:>10.2}{:>10.2}{:>8.2}", row.cpp, ours / row.cpp),
            None => writeln!(text, "{:>10}{:>10.2}", "-", row.cpp),
        };
    }
    text
}

/// JSON object with the disk and an array of figures.
pub fn json(disk: &DiskProfile, rows: &[FigureRow]) -> Value {
    let object = |row: &FigureRow| {
        json!({
            "what": row.scenario,
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
