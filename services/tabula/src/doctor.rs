//! `tabula doctor`: checks this machine and explains.

mod checks;

use command_line::Output;
use serde::Serialize;
use service::{CommonArguments, exit_code};
use std::process::ExitCode;

/// How a check went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Verdict {
    /// All is well.
    Ok,
    /// The daemon runs, with something missing.
    Warning,
    /// The daemon will not run.
    Failure,
}

/// One finding.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Finding {
    check: &'static str,
    verdict: Verdict,
    sentence: String,
}

impl Finding {
    fn new(check: &'static str, verdict: Verdict, sentence: impl Into<String>) -> Self {
        Self {
            check,
            verdict,
            sentence: sentence.into(),
        }
    }
}

#[derive(Serialize)]
struct Document {
    findings: Vec<Finding>,
}

/// Runs all checks; the exit code is a failure when one of them is.
pub(crate) fn run(common: &CommonArguments, output: &Output) -> ExitCode {
    let document = Document {
        findings: checks::all(common),
    };
    output.answer(&document, || text(&document.findings));
    let has_failed = document
        .findings
        .iter()
        .any(|f| f.verdict == Verdict::Failure);
    ExitCode::from(if has_failed { exit_code::FAILURE } else { 0 })
}

fn text(findings: &[Finding]) -> String {
    let line = |finding: &Finding| {
        let mark = match finding.verdict {
            Verdict::Ok => "ok     ",
            Verdict::Warning => "warning",
            Verdict::Failure => "FAILURE",
        };
        format!("{mark}  {}: {}", finding.check, finding.sentence)
    };
    findings.iter().map(line).collect::<Vec<_>>().join("\n")
}
