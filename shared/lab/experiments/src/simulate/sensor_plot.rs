//! `tabula-lab simulate sensor`: depth noise of the simulated Kinect against the published noise
//! model.

use crate::output_files::{create_folder, write};
use command_line::{Output, progress_bar};
use evaluation::sensor_error;
use serde::Serialize;
use service::Failure;
use std::path::Path;
use std::process::ExitCode;

#[derive(Serialize)]
struct SensorNoiseReport {
    table: String,
    plot: String,
    smallest_ratio: f64,
    largest_ratio: f64,
}

/// Measures the depth noise; writes the table and the plot.
pub(super) fn run(out: &Path, output: &Output) -> Result<ExitCode, Failure> {
    let bar = progress_bar(sensor_error::N_PLACEMENTS as u64, "placements", output);
    let figures = sensor_error::measure(|| bar.inc(1)).map_err(Failure::general)?;
    bar.finish_and_clear();
    let (table, plot) = (out.join("sensor-error.csv"), out.join("sensor-error.svg"));
    create_folder(out)?;
    write(&table, figures.csv().as_bytes())?;
    write(&plot, figures.svg().map_err(Failure::general)?.as_bytes())?;
    let rows = figures.by_distance.iter().chain(&figures.by_angle);
    let ratios: Vec<f64> = rows.map(|row| row.measured_m / row.published_m).collect();
    let document = SensorNoiseReport {
        table: table.display().to_string(),
        plot: plot.display().to_string(),
        smallest_ratio: ratios.iter().copied().fold(f64::INFINITY, f64::min),
        largest_ratio: ratios.iter().copied().fold(0.0, f64::max),
    };
    output.answer(&document, || {
        format!(
            "simulated spread of depth over the published one: {:.3} to {:.3}\n{}\n{}",
            document.smallest_ratio, document.largest_ratio, document.table, document.plot
        )
    });
    Ok(ExitCode::SUCCESS)
}
