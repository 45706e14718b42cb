//! `tabula-lab evaluate registration`: pairs of views of one object are moved apart and
//! registered again.

mod pair_files;
mod report;
mod report_page;
mod simulated_pairs;
mod trials;

use crate::arguments::RegistrationArguments;
use crate::output_files::{create_folder, write};
use command_line::{Output, progress_bar};
use plot::forest_plot;
use report::{PairReport, RegistrationReport};
use report_page::{CAPTION, PICTURE};
use service::Failure;
use std::path::Path;
use std::process::ExitCode;
use trials::{ROTATIONS_DEG, TRANSLATIONS_CM};

/// Runs all trials of all pairs and reports the figures.
pub(super) fn run(arguments: &RegistrationArguments, output: &Output) -> Result<ExitCode, Failure> {
    let pairs = match (&arguments.pairs, &arguments.models) {
        (Some(folder), _) => pair_files::read(folder)?,
        (None, Some(_)) => simulated_pairs::simulate(arguments, output)?,
        (None, None) => {
            let sentence = "there are no views to register; name a folder of pairs, or models \
                            with --models";
            return Err(Failure::usage(sentence));
        }
    };
    let n_trials = ROTATIONS_DEG.len() * TRANSLATIONS_CM.len() * arguments.starts as usize;
    let bar = progress_bar((pairs.len() * n_trials) as u64, "registrations", output);
    let mut reports = Vec::new();
    for pair in &pairs {
        let trials = trials::run(pair, arguments, &bar)?;
        reports.push(PairReport::of(pair, &trials, arguments.seed));
    }
    bar.finish_and_clear();
    let report = RegistrationReport::of(arguments, reports);
    if let Some(out) = &arguments.out {
        write_all(&report, out)?;
        if arguments.pairs.is_none() {
            pair_files::write_all(&pairs, &out.join("pairs"))?;
        }
    }
    output.answer(&report, || report_page::text(&report));
    Ok(ExitCode::SUCCESS)
}

fn write_all(report: &RegistrationReport, out: &Path) -> Result<(), Failure> {
    create_folder(out)?;
    let svg = forest_plot::svg(CAPTION, "success", &report_page::figure_rows(report));
    let svg = svg.map_err(Failure::general)?;
    write(&out.join(PICTURE), svg.as_bytes())?;
    let json = serde_json::to_string_pretty(report).map_err(Failure::general)?;
    write(&out.join("registration.json"), json.as_bytes())?;
    write(
        &out.join("index.html"),
        report_page::page(report).as_bytes(),
    )
}

#[cfg(test)]
mod tests;
