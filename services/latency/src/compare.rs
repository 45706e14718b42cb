//! `tabula latency compare`: A/B comparison of two latency reports.

use crate::report_text;
use crate::results::{AcceptanceResult, exit_code, read_report};
use command_line::Output;
use latency_report::compare;
use service::Failure;
use std::path::Path;
use std::process::ExitCode;

/// Prints which latencies are faster, slower or undecided.
pub(crate) fn run(before: &Path, now: &Path, output: &Output) -> Result<ExitCode, Failure> {
    let comparisons = compare(&read_report(before)?, &read_report(now)?);
    output.answer(&comparisons, || report_text::comparison(&comparisons));
    let acceptance = AcceptanceResult {
        violations: None,
        comparisons: Some(comparisons),
    };
    Ok(exit_code(acceptance.is_over()))
}
