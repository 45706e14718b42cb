//! `tabula latency machine`: system noise of this computer.

use crate::results::not_written;
use command_line::Output;
use service::Failure;
use std::path::Path;
use std::process::ExitCode;
use system_noise::{MachineReport, MeasurementPlan, latency_histograms, measure, report};

/// Measures, prints, and writes the report and the histograms.
pub(crate) fn run(short: bool, out: Option<&Path>, output: &Output) -> Result<ExitCode, Failure> {
    let plan = if short {
        MeasurementPlan::SHORT
    } else {
        MeasurementPlan::FULL
    };
    let found = measure(&plan, &mut |sentence| output.print_status(sentence));
    if let Some(folder) = out {
        write(folder, &found)?;
    }
    output.answer(&found, || report::text(&found));
    Ok(ExitCode::SUCCESS)
}

fn write(folder: &Path, found: &MachineReport) -> Result<(), Failure> {
    dataset::create_folder(folder).map_err(not_written)?;
    let document = serde_json::to_string(found).map_err(not_written)?;
    dataset::write_atomic(&folder.join("machine.json"), document).map_err(not_written)?;
    let picture = latency_histograms::histograms(found).map_err(not_written)?;
    dataset::write_atomic(&folder.join("machine.svg"), picture).map_err(not_written)
}
