//! `tabula latency merge`: merges the histograms of several measurements.

use crate::report_text;
use crate::results::read;
use command_line::{Output, format_table};
use latency_report::{DurationPercentiles, Histograms};
use serde::Serialize;
use service::Failure;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Percentiles of one merged stage, milliseconds.
#[derive(Serialize)]
struct MergedStage {
    stage: String,
    count: u64,
    #[serde(flatten)]
    ms: DurationPercentiles,
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
    let stages = merged.iter().map(|(stage, count, ms)| MergedStage {
        stage: stage.to_owned(),
        count,
        ms,
    });
    let stages: Vec<MergedStage> = stages.collect();
    output.answer(&stages, || text(&stages));
    Ok(ExitCode::SUCCESS)
}

fn text(stages: &[MergedStage]) -> String {
    let rows: Vec<Vec<String>> = stages
        .iter()
        .map(|stage| {
            let mut row = report_text::times(&stage.stage, &stage.ms);
            row.insert(1, stage.count.to_string());
            row
        })
        .collect();
    format_table(
        &["stage", "count", "p50 ms", "p90", "p99", "p99.9", "max"],
        &rows,
    )
}
