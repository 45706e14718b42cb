//! `tabula latency merge`: merges the histograms of several measurements.

use crate::results::read;
use command_line::{Output, format_table};
use latency_report::Histograms;
use serde::Serialize;
use service::Failure;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Percentiles of one merged stage, milliseconds.
#[derive(Serialize)]
struct MergedStage {
    stage: String,
    count: u64,
    p50: f64,
    p90: f64,
    p99: f64,
    p999: f64,
    max: f64,
}

/// Prints the percentiles over all files and writes the merged histograms.
pub(crate) fn run(
    files: &[PathBuf],
    out: Option<&Path>,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let failed = |path: &Path, error: &dyn std::fmt::Display| {
        Failure::usage(format!("{}: {error}", path.display()))
    };
    let mut merged = Histograms::default();
    for path in files {
        let histograms = Histograms::parse(&read(path)?).map_err(|error| failed(path, &error))?;
        merged
            .merge(&histograms)
            .map_err(|error| failed(path, &error))?;
    }
    if let Some(path) = out {
        let text = merged.to_text(0.0).map_err(|error| failed(path, &error))?;
        dataset::write_atomic(path, text).map_err(Failure::general)?;
    }
    let stages: Vec<MergedStage> = merged.iter().map(row).collect();
    output.answer(&stages, || text(&stages));
    Ok(ExitCode::SUCCESS)
}

fn row((stage, count, at): (&str, u64, impl Fn(f64) -> u64)) -> MergedStage {
    let ms = |share: f64| at(share) as f64 / 1e6;
    MergedStage {
        stage: stage.to_owned(),
        count,
        p50: ms(0.5),
        p90: ms(0.9),
        p99: ms(0.99),
        p999: ms(0.999),
        max: ms(1.0),
    }
}

fn text(stages: &[MergedStage]) -> String {
    let rows: Vec<Vec<String>> = stages
        .iter()
        .map(|stage| {
            let times = [stage.p50, stage.p90, stage.p99, stage.p999, stage.max];
            let mut row = vec![stage.stage.clone(), stage.count.to_string()];
            row.extend(times.map(|ms| format!("{ms:.3}")));
            row
        })
        .collect();
    format_table(
        &["stage", "count", "p50 ms", "p90", "p99", "p99.9", "max"],
        &rows,
    )
}
