//! Text of a latency report.

use crate::results::AcceptanceResult;
use command_line::format_table;
use latency_report::{
    BudgetViolation, Comparison, ComparisonVerdict, DurationPercentiles, LatencyReport, StageReport,
};
use message::{Stage, StageScope};

/// Column headings of the table of stages.
const HEADING: [&str; 11] = [
    "stage",
    "p50 ms",
    "p90",
    "p99",
    "p99.9",
    "max",
    "cpu ms",
    "blocked",
    "preempted",
    "allocs",
    "faults",
];

/// Whole latency report as text, without budget and comparison.
pub(crate) fn text(report: &LatencyReport) -> String {
    let mut parts: Vec<String> = report
        .conditions
        .warnings
        .iter()
        .map(|warning| format!("warning: {warning}"))
        .collect();
    parts.push(summary(report));
    parts.push(stages(report));
    parts.push(processes(report));
    parts.push(worst(report));
    parts.push(checks(report));
    parts.join("\n")
}

fn summary(report: &LatencyReport) -> String {
    let LatencyReport {
        frames,
        dropped,
        not_captured,
        seconds,
        objects,
        period_ms,
        ..
    } = report;
    format!(
        "{frames} frames in {seconds:.1} s, one every {period_ms:.2} ms, from {}; dropped {dropped}, \
         not captured {not_captured}; {:.1} objects in a frame, {} at most",
        report.conditions.source, objects.mean, objects.max
    )
}

/// Table of stages, grouped by the stage they belong to.
fn stages(report: &LatencyReport) -> String {
    let mut rows = vec![
        times("end to end", &report.end_to_end_ms),
        times("label of an object", &report.object_label_ms),
        vec![String::new()],
    ];
    let of_scope = |scope: StageScope| {
        let stages = Stage::ALL.iter().copied();
        stages.filter(move |stage| stage.scope() == scope)
    };
    let indented = |scope| of_scope(scope).filter_map(|stage| row(report, stage, "  "));
    for stage in of_scope(StageScope::Frame) {
        rows.extend(row(report, stage, ""));
        rows.extend(indented(StageScope::Within(stage)));
        if stage == Stage::Objects {
            rows.extend(indented(StageScope::Object));
        }
    }
    rows.push(vec!["beside".into()]);
    rows.extend(indented(StageScope::Outside));
    format_table(&HEADING, &rows)
}

pub(crate) fn times(name: &str, ms: &DurationPercentiles) -> Vec<String> {
    let mut row = vec![name.to_owned()];
    row.extend(
        DurationPercentiles::NAMED
            .iter()
            .map(|(_, get)| format!("{:.3}", get(ms))),
    );
    row
}

/// Row of a stage; resource usage is the mean per interval.
fn row(report: &LatencyReport, stage: Stage, indent: &str) -> Option<Vec<String>> {
    let StageReport {
        ms, count, usage, ..
    } = report.stage(stage)?;
    let mut row = times(&format!("{indent}{}", stage.word()), ms);
    let mean = |sum: u64| sum as f64 / (*count).max(1) as f64;
    if usage.cpu_ns > 0 {
        row.push(format!("{:.3}", mean(usage.cpu_ns) / 1e6));
        let faults = usage.minor_faults + usage.major_faults;
        let counts = [
            usage.voluntary_switches,
            usage.involuntary_switches,
            usage.allocations,
            faults,
        ];
        row.extend(counts.map(|sum| format!("{:.2}", mean(sum))));
    }
    Some(row)
}

fn processes(report: &LatencyReport) -> String {
    let rows: Vec<Vec<String>> = report
        .conditions
        .processes
        .iter()
        .map(|process| {
            vec![
                process.process.clone(),
                process.pid.to_string(),
                format!("{:.2}", process.cores),
                format!("{:.0}", process.resident_mb),
                process.open_files.to_string(),
                process.threads.to_string(),
                format!(
                    "{} + {}",
                    process.voluntary_switches, process.involuntary_switches
                ),
                format!("{} + {}", process.minor_faults, process.major_faults),
            ]
        })
        .collect();
    let heading = [
        "process",
        "pid",
        "cores",
        "resident MB",
        "files",
        "threads",
        "blocked + preempted",
        "faults minor + major",
    ];
    let memory = &report.conditions.shared_memory;
    format!(
        "\n{}\nthe daemon without its source uses {:.2} cores; shared memory {:.1} of {:.0} MB",
        format_table(&heading, &rows),
        report.cores_without_source(),
        memory.used_bytes as f64 / 1e6,
        memory.reserved_bytes as f64 / 1e6,
    )
}

fn worst(report: &LatencyReport) -> String {
    let lines = report.worst.iter().map(|frame| {
        format!(
            "  frame {}, {:.2} ms: {}",
            frame.sequence, frame.end_to_end_ms, frame.reason
        )
    });
    let lines: Vec<String> = std::iter::once("\nthe worst frames".to_owned())
        .chain(lines)
        .collect();
    lines.join("\n")
}

fn checks(report: &LatencyReport) -> String {
    let check = &report.sum_check;
    let overhead = &report.overhead;
    let verdict = if check.passes() {
        "the stages add up to end to end".to_owned()
    } else {
        format!(
            "THE STAGES DO NOT ADD UP in {} chain(s): the figures are wrong",
            check.over
        )
    };
    format!(
        "\n{verdict}: largest difference {:.4} % of {} frames, {:.4} % of {} objects\n\
         measuring: {:.0} spans a frame, {:.0} ns a stage, {:.4} ms a frame, {:.2} % of it",
        100.0 * check.worst_frame_share,
        check.frames,
        100.0 * check.worst_object_share,
        check.objects,
        overhead.spans_per_frame,
        overhead.stage_cost_ns,
        overhead.cost_per_frame_ms,
        100.0 * overhead.share_of_frame,
    )
}

/// Budget violations and comparison; empty without budget and baseline.
pub(crate) fn acceptance(acceptance: &AcceptanceResult) -> String {
    let mut parts = vec![String::new()];
    parts.extend(acceptance.violations.as_deref().map(budget));
    parts.extend(acceptance.comparisons.as_deref().map(comparison));
    if parts.len() == 1 {
        return String::new();
    }
    parts.join("\n\n")
}

fn budget(violations: &[BudgetViolation]) -> String {
    if violations.is_empty() {
        return "all limits of the budget are kept".into();
    }
    let lines = violations.iter().map(|excess| {
        format!(
            "over budget: {}, {:.3} instead of {:.3}",
            excess.what, excess.measured, excess.limit
        )
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Comparison table: all decided figures, and always end to end.
pub(crate) fn comparison(comparisons: &[Comparison]) -> String {
    let is_told = |comparison: &&Comparison| {
        comparison.verdict != ComparisonVerdict::Undecided || comparison.what == "end_to_end"
    };
    let rows: Vec<Vec<String>> = comparisons
        .iter()
        .filter(is_told)
        .map(|comparison| {
            let [low, high] = comparison.ratio_interval;
            vec![
                comparison.what.clone(),
                comparison.percentile.to_owned(),
                format!("{:.3}", comparison.before_ms),
                format!("{:.3}", comparison.now_ms),
                format!("{:.3} ({low:.3} to {high:.3})", comparison.ratio),
                comparison.verdict.word().to_owned(),
            ]
        })
        .collect();
    let n_undecided = comparisons
        .iter()
        .filter(|comparison| comparison.verdict == ComparisonVerdict::Undecided)
        .count();
    let heading = [
        "stage",
        "",
        "before ms",
        "now ms",
        "now / before (95 %)",
        "",
    ];
    format!(
        "{}\n{n_undecided} of {} undecided",
        format_table(&heading, &rows),
        comparisons.len()
    )
}
