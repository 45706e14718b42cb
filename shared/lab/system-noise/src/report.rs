//! Text report of a system-noise measurement.

mod environment;
mod text_table;

use crate::disturbance::Disturbance;
use crate::fingerprint::Fingerprint;
use crate::measurement::MachineReport;
use crate::mitigation::{EffectVerdict, Mitigation, MitigationEffect};
use crate::samples::{LatencySummary, Samples};
use std::fmt::Write as _;
use text_table::TextTable;

/// Whole report for a terminal: environment, disturbance, warnings, noise, effects,
/// recommendations. Times are in µs.
pub fn text(report: &MachineReport) -> String {
    let mut text = String::new();
    let mut section = |title: &str, body: &str| {
        if !body.is_empty() {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{title}\n{}\n", indented(body));
        }
    };
    let print = &report.fingerprint;
    section("Environment", &environment(print));
    section("Meanwhile", &disturbance(&report.disturbance));
    section("What makes these figures untrue", &warnings(report));
    section("Latencies, µs", &latencies(report));
    section("Interruptions of a spinning thread", &interruptions(report));
    section("Reading a clock", &clocks(report));
    section(
        "Memory, GB/s (10^9 bytes a second, best round)",
        &memory(report),
    );
    section(
        "Real-time settings, p50 / p99 / p99.9 in µs",
        &latency_effects(report),
    );
    section("Huge pages, GB/s on one thread", &bandwidth_effects(report));
    section("Advice", &recommendations(report));
    section("Not measured", &not_measured(report));
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// Environment section, one line per reported value.
pub fn environment(fingerprint: &Fingerprint) -> String {
    environment::of_fingerprint(fingerprint)
}

/// Disturbance section, one line per reported value.
pub fn disturbance(disturbance: &Disturbance) -> String {
    environment::of_disturbance(disturbance)
}

/// Table of percentiles in µs, one line per probe.
pub fn latency_table(latencies: &[Samples]) -> String {
    let mut table = TextTable::new(&["", "n", "p50", "p90", "p99", "p99.9", "max"]);
    for samples in latencies {
        table.row(latency_row(samples));
    }
    table.to_string()
}

fn indented(body: &str) -> String {
    let lines = body.trim_end().lines().map(|line| match line {
        "" => String::new(),
        line => format!("  {line}"),
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn us(time_ns: u64) -> String {
    format!("{:.2}", time_ns as f64 / 1000.0)
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

/// Latency section: one line per probe, followed by their meanings.
fn latencies(report: &MachineReport) -> String {
    let table = latency_table(&report.latencies);
    let meanings = report.latencies.iter();
    let meanings = meanings.map(|samples| format!("{}: {}.\n", samples.name, samples.meaning));
    format!("{table}\n{}", meanings.collect::<String>())
}

fn latency_row(samples: &Samples) -> Vec<String> {
    let name = samples.name.clone();
    let Some(s) = samples.summary else {
        return vec![name, "0".to_owned()];
    };
    let times = [s.p50_ns, s.p90_ns, s.p99_ns, s.p99_9_ns, s.max_ns].map(us);
    [name, s.n.to_string()].into_iter().chain(times).collect()
}

fn interruptions(report: &MachineReport) -> String {
    let found = &report.interruptions;
    let watched_s = found.watched_ns as f64 / 1e9;
    let mut text = format!(
        "{} gaps of more than 5 µs in {watched_s:.1} s, {:.0} a second; {:.3} % of the time \
         lost; longest {} µs\n",
        found.n_gaps,
        found.n_gaps as f64 / watched_s.max(1e-9),
        100.0 * found.share,
        us(found.longest_ns)
    );
    if let Some(s) = found.gaps.summary {
        let (p50, p99) = (us(s.p50_ns), us(s.p99_ns));
        let _ = writeln!(text, "a gap: p50 {p50} µs, p99 {p99} µs");
    }
    text
}

fn clocks(report: &MachineReport) -> String {
    let mut table = TextTable::new(&["", "ns"]);
    for clock in &report.clocks {
        table.row(vec![
            clock.clock.clone(),
            format!("{:.1}", clock.reading_ns),
        ]);
    }
    table.to_string()
}

fn memory(report: &MachineReport) -> String {
    let mut table = TextTable::new(&["", "threads", "MB", "best", "worst"]);
    for one in &report.bandwidths {
        let rounds = one.rounds_gb_per_s.iter().copied();
        table.row(vec![
            one.operation.name().to_owned(),
            one.n_threads.to_string(),
            format!("{:.1}", one.n_bytes as f64 / 1e6),
            format!("{:.1}", one.best_gb_per_s),
            format!("{:.1}", rounds.fold(f64::INFINITY, f64::min)),
        ]);
    }
    table.to_string()
}

fn latency_effects(report: &MachineReport) -> String {
    let mut table = TextTable::new(&["", "probe", "machine", "as it is", "with it", "verdict"]);
    let shown = |s: &LatencySummary| [s.p50_ns, s.p99_ns, s.p99_9_ns].map(us).join(" / ");
    for effect in &report.effects {
        if let MitigationEffect::Latency {
            mitigation,
            probe,
            is_loaded,
            before,
            after,
            verdict,
        } = effect
        {
            let machine = if *is_loaded { "busy" } else { "idle" };
            table.row(vec![
                setting(*mitigation).to_owned(),
                probe.clone(),
                machine.to_owned(),
                shown(before),
                shown(after),
                word(*verdict).to_owned(),
            ]);
        }
    }
    table.to_string()
}

fn bandwidth_effects(report: &MachineReport) -> String {
    let mut table = TextTable::new(&["", "without", "with", "verdict"]);
    for effect in &report.effects {
        if let MitigationEffect::Bandwidth {
            operation,
            before_gb_per_s,
            after_gb_per_s,
            verdict,
            ..
        } = effect
        {
            table.row(vec![
                operation.name().to_owned(),
                format!("{before_gb_per_s:.1}"),
                format!("{after_gb_per_s:.1}"),
                word(*verdict).to_owned(),
            ]);
        }
    }
    table.to_string()
}

fn setting(mitigation: Mitigation) -> &'static str {
    match mitigation {
        Mitigation::Governor => "governor",
        Mitigation::Isolation => "isolated core",
        Mitigation::RealTime => "SCHED_FIFO 80",
        Mitigation::TimerSlack => "no timer slack",
        Mitigation::OneCore => "on one core",
        Mitigation::LockedMemory => "memory locked",
        Mitigation::HugePages => "huge pages",
    }
}

fn word(verdict: EffectVerdict) -> &'static str {
    match verdict {
        EffectVerdict::Better => "better",
        EffectVerdict::NoDifference => "no difference",
        EffectVerdict::Worse => "worse",
        EffectVerdict::Mixed => "mixed",
    }
}

fn recommendations(report: &MachineReport) -> String {
    let lines = report
        .recommendations
        .iter()
        .map(|advice| format!("- {}\n  {}\n", advice.what_to_do, advice.finding));
    lines.collect()
}

fn not_measured(report: &MachineReport) -> String {
    let lines = report.not_measured.iter();
    let lines = lines.map(|one| format!("- {}: {}\n", one.name, one.why));
    lines.collect()
}
