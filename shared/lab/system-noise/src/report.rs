//! Text report of a system-noise measurement.

mod environment;

use crate::measurement::MachineReport;
use command_line::format_table;
use environment::{of_disturbance, of_fingerprint};
use std::fmt::Write as _;

/// Whole report for a terminal: environment, disturbance, warnings, noise. Times are in µs.
pub fn text(report: &MachineReport) -> String {
    let mut text = String::new();
    let mut section = |title: &str, body: &str| {
        if !body.is_empty() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{title}\n{}\n", indented(body));
        }
    };
    section("Environment", &of_fingerprint(&report.fingerprint));
    section("Meanwhile", &of_disturbance(&report.disturbance));
    section("What makes these figures untrue", &warnings(report));
    section("Timer latency, µs", &timers(report));
    section("Interruptions of a spinning thread", &interruptions(report));
    section("Memory, GB/s (10^9 bytes a second)", &memory(report));
    section("Not measured", &not_measured(report));
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

fn indented(body: &str) -> String {
    let lines = body.trim_end().lines().map(|line| match line {
        "" => String::new(),
        line => format!("  {line}"),
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn warnings(report: &MachineReport) -> String {
    let lines = report
        .warnings
        .iter()
        .map(|warning| format!("- {warning}\n"));
    let lines: String = lines.collect();
    if lines.is_empty() {
        "no warnings".to_owned()
    } else {
        lines
    }
}

fn timers(report: &MachineReport) -> String {
    let heading = [
        "machine", "thread", "n", "p50", "p90", "p99", "p99.9", "max",
    ];
    let rows = report.timers.iter().map(|trial| {
        let machine = if trial.is_loaded { "busy" } else { "idle" };
        let percentiles = [0.5, 0.9, 0.99, 0.999].map(|share| trial.percentile_us(share));
        let figures = [trial.n]
            .into_iter()
            .chain(percentiles)
            .chain([trial.max_us]);
        let words = [machine, trial.setting.word()].map(str::to_owned);
        words
            .into_iter()
            .chain(figures.map(|figure| figure.to_string()))
            .collect()
    });
    table(&heading, &rows.collect::<Vec<_>>())
}

fn interruptions(report: &MachineReport) -> String {
    let sentence = report.interruptions.as_ref().map(|found| {
        format!(
            "{} gaps of 5 µs and more in {:.1} s, {:.0} a second; {:.3} % of the time lost; \
             longest {} µs\n",
            found.n_gaps,
            found.watched_s,
            found.n_gaps as f64 / found.watched_s.max(1e-9),
            100.0 * found.share,
            found.longest_us
        )
    });
    sentence.unwrap_or_default()
}

fn memory(report: &MachineReport) -> String {
    let rows = report.bandwidths.iter().map(|one| {
        vec![
            one.n_threads.to_string(),
            format!("{:.1}", one.read_gb_per_s),
            format!("{:.1}", one.write_gb_per_s),
        ]
    });
    table(&["threads", "read", "write"], &rows.collect::<Vec<_>>())
}

/// Table, or an empty text without rows.
fn table(heading: &[&str], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    format_table(heading, rows)
}

fn not_measured(report: &MachineReport) -> String {
    let lines = report.not_measured.iter();
    let lines = lines.map(|one| format!("- {}: {}\n", one.name, one.why));
    lines.collect()
}
