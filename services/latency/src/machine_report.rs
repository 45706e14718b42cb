//! `tabula latency machine`: system noise of this computer.

use crate::results::write_with_figure;
use command_line::Output;
use service::Failure;
use std::path::Path;
use std::process::ExitCode;
use system_noise::{MeasurementPlan, latency_histograms, measure, report};

/// Measures, prints, and writes the report and the histograms.
pub(crate) fn run(short: bool, out: Option<&Path>, output: &Output) -> Result<ExitCode, Failure> {
    let plan = if short {
        MeasurementPlan::SHORT
    } else {
        MeasurementPlan::FULL
    };
    let found = measure(&plan, &mut |sentence| output.print_status(sentence));
    if let Some(folder) = out {
        let figure = latency_histograms::histograms(&found);
        write_with_figure(folder, "machine", &found, figure)?;
    }
    output.answer(&found, || report::text(&found));
    Ok(ExitCode::SUCCESS)
}
