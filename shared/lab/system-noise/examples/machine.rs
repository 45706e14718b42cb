//! Prints the system-noise report of this computer; with a folder as argument, writes
//! `machine.json` and `machine.svg` into it.
#![expect(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "the example prints its result"
)]

use std::error::Error;
use std::path::PathBuf;
use system_noise::{MeasurementPlan, latency_histograms, measure, report};

fn main() -> Result<(), Box<dyn Error>> {
    let found = measure(&MeasurementPlan::FULL, &mut |sentence| {
        eprintln!("{sentence}");
    });
    print!("{}", report::text(&found));
    if let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) {
        std::fs::create_dir_all(&folder)?;
        let json = serde_json::to_string(&found)?;
        std::fs::write(folder.join("machine.json"), json)?;
        std::fs::write(
            folder.join("machine.svg"),
            latency_histograms::histograms(&found)?,
        )?;
    }
    Ok(())
}
