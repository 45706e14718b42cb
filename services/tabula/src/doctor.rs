//! `tabula doctor`: diagnosis of this machine.

mod checks;
mod configuration;
mod depth_noise;
mod expected_processes;

use command_line::Output;
use serde::Serialize;
use service::{CommonArguments, exit_code};
use std::process::ExitCode;

/// Severity of a diagnostic finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Severity {
    /// No problem found.
    Ok,
    /// Warning: the daemon runs with reduced function.
    Warning,
    /// Failure: the daemon cannot run.
    Failure,
}

/// Finding of one diagnostic check.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Finding {
    check: &'static str,
    #[serde(rename = "verdict")]
    severity: Severity,
    sentence: String,
}

impl Finding {
    fn new(check: &'static str, severity: Severity, sentence: impl Into<String>) -> Self {
        Self {
            check,
            severity,
            sentence: sentence.into(),
        }
    }
}

#[derive(Serialize)]
struct DoctorReport {
    findings: Vec<Finding>,
}

/// Runs all checks; the exit code is a failure if one of them fails.
pub(crate) fn run(common: &CommonArguments, output: &Output) -> ExitCode {
    let report = DoctorReport {
        findings: checks::run_all(common),
    };
    output.answer(&report, || text(&report.findings));
    let has_failed = report
        .findings
        .iter()
        .any(|f| f.severity == Severity::Failure);
    ExitCode::from(if has_failed { exit_code::FAILURE } else { 0 })
}

fn text(findings: &[Finding]) -> String {
    let line = |finding: &Finding| {
        let mark = match finding.severity {
            Severity::Ok => "ok     ",
            Severity::Warning => "warning",
            Severity::Failure => "FAILURE",
        };
        format!("{mark}  {}: {}", finding.check, finding.sentence)
    };
    findings.iter().map(line).collect::<Vec<_>>().join("\n")
}
