//! Results of a measurement: output files, budget check, comparison with a baseline.

use crate::arguments::MeasureArguments;
use latency_report::{
    Budget, BudgetViolation, Comparison, ComparisonVerdict, Histograms, LatencyRecorder,
    LatencyReport, chrome_trace, compare, percentile_figure, time_figure,
};
use serde::Serialize;
use service::{Failure, exit_code};
use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;

/// Acceptance criteria of a report: budget and baseline.
pub(crate) struct AcceptanceCriteria {
    budget: Option<Budget>,
    baseline: Option<LatencyReport>,
}

/// Result of checking budget and baseline.
#[derive(Debug, Default, Serialize)]
pub(crate) struct AcceptanceResult {
    #[serde(rename = "over_budget", skip_serializing_if = "Option::is_none")]
    pub(crate) violations: Option<Vec<BudgetViolation>>,
    #[serde(rename = "comparison", skip_serializing_if = "Option::is_none")]
    pub(crate) comparisons: Option<Vec<Comparison>>,
}

/// JSON document of a latency measurement.
#[derive(Serialize)]
pub(crate) struct ReportDocument<'a> {
    #[serde(flatten)]
    pub(crate) report: &'a LatencyReport,
    #[serde(flatten)]
    pub(crate) acceptance: &'a AcceptanceResult,
}

impl AcceptanceCriteria {
    /// Reads the budget and the baseline report.
    ///
    /// # Errors
    /// If a file cannot be read or parsed.
    pub(crate) fn prepare(arguments: &MeasureArguments) -> Result<Self, Failure> {
        let budget = arguments.budget.as_deref().map(|path| {
            let text = read(path)?;
            Budget::parse(&text).map_err(|error| unusable(path, "budget", error))
        });
        Ok(Self {
            budget: budget.transpose()?,
            baseline: arguments.baseline.as_deref().map(read_report).transpose()?,
        })
    }

    pub(crate) fn judge(&self, report: &LatencyReport) -> AcceptanceResult {
        let budget = self.budget.as_ref();
        let baseline = self.baseline.as_ref();
        AcceptanceResult {
            violations: budget.map(|budget| budget.violations(report)),
            comparisons: baseline.map(|baseline| compare(baseline, report)),
        }
    }
}

impl AcceptanceResult {
    /// `true` if a limit is exceeded or a figure has become slower.
    pub(crate) fn is_over(&self) -> bool {
        let is_over = |violations: &Vec<BudgetViolation>| !violations.is_empty();
        let is_slower = |comparisons: &Vec<Comparison>| {
            comparisons
                .iter()
                .any(|comparison| comparison.verdict == ComparisonVerdict::Slower)
        };
        self.violations.as_ref().is_some_and(is_over)
            || self.comparisons.as_ref().is_some_and(is_slower)
    }
}

fn unusable(path: &Path, kind: &str, error: impl Display) -> Failure {
    let sentence = format!("{} is no {kind}: {error}", path.display());
    Failure::usage(sentence)
}

/// Reads a file's text.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| {
        let sentence = format!("{} cannot be read: {error}", path.display());
        Failure::usage(sentence)
    })
}

/// Reads a report.
///
/// # Errors
/// If it cannot be read or parsed.
pub(crate) fn read_report(path: &Path) -> Result<LatencyReport, Failure> {
    serde_json::from_str(&read(path)?).map_err(|error| unusable(path, "report", error))
}

/// Exit code of a measurement: 7 if it is over a limit.
pub(crate) fn exit_code(is_over: bool) -> ExitCode {
    if is_over {
        ExitCode::from(exit_code::OVER_BUDGET)
    } else {
        ExitCode::SUCCESS
    }
}

/// Writes a JSON document and its figure into a folder, under one name.
pub(crate) fn write_with_figure(
    folder: &Path,
    name: &str,
    document: &impl Serialize,
    figure: Result<String, impl Display>,
) -> Result<(), Failure> {
    dataset::create_folder(folder).map_err(not_written)?;
    let put = |ending: &str, text: String| {
        dataset::write_atomic(&folder.join(format!("{name}.{ending}")), text).map_err(not_written)
    };
    let json = serde_json::to_string(document).map_err(not_written)?;
    put("json", json)?;
    put("svg", figure.map_err(not_written)?)
}

/// Writes all results into a folder, which is created if missing.
///
/// # Errors
/// If a file cannot be written.
pub(crate) fn write(
    folder: &Path,
    report: &LatencyReport,
    recorder: &LatencyRecorder,
) -> Result<(), Failure> {
    dataset::create_folder(folder).map_err(not_written)?;
    let put = |name: &str, text: String| {
        dataset::write_atomic(&folder.join(name), text).map_err(not_written)
    };
    put(
        "report.json",
        serde_json::to_string(report).map_err(not_written)?,
    )?;
    put("timeline.json", chrome_trace(&recorder.kept()).to_string())?;
    let histograms = histograms(recorder).map_err(not_written)?;
    put(
        "latency.hlog",
        histograms.to_text(report.seconds).map_err(not_written)?,
    )?;
    put(
        "percentiles.svg",
        percentile_figure(recorder).map_err(not_written)?,
    )?;
    put("over-time.svg", time_figure(recorder).map_err(not_written)?)
}

/// Failure: measurement results could not be written.
pub(crate) fn not_written(error: impl Display) -> Failure {
    let sentence = format!("the results could not be written: {error}");
    Failure::general(sentence)
}

fn histograms(
    recorder: &LatencyRecorder,
) -> Result<Histograms, latency_report::HistogramFileError> {
    let mut histograms = Histograms::default();
    histograms.add_end_to_end(&recorder.end_to_end_ns(&recorder.missed()))?;
    for (stage, durations_ns) in recorder.stages_ns() {
        histograms.add(stage.word(), &durations_ns)?;
    }
    Ok(histograms)
}
