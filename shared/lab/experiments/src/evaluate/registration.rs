//! `tabula-lab evaluate registration`: pairs of views of one object are moved apart and
//! registered again.

mod pair_files;
mod report;
mod report_page;
mod simulated_pairs;
mod trials;

use crate::arguments::RegistrationArguments;
use crate::evaluate::tabular_report::forest_figure;
use crate::output_files::create_folder;
use command_line::{Output, progress_bar};
use report::{PairReport, RegistrationReport};
use service::Failure;
use std::process::ExitCode;
use trials::{ROTATIONS_DEG, TRANSLATIONS_CM};

/// Runs all trials of all pairs and reports the figures.
pub(super) fn run(arguments: &RegistrationArguments, output: &Output) -> Result<ExitCode, Failure> {
    let pairs = match (&arguments.pairs, &arguments.models) {
        (Some(folder), _) => pair_files::read(folder)?,
        (None, Some(models)) => simulated_pairs::simulate(models, arguments, output)?,
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
    let mut page = report_page::page(&report);
    if let Some(out) = &arguments.out {
        create_folder(out)?;
        let caption = "Successful registrations of each pair with their 95 % interval";
        let rows = report_page::figure_rows(&report);
        page.figures.push(forest_figure(
            out,
            "success.svg",
            (caption, "success"),
            &rows,
        )?);
        page.write(out, "registration.json", &report)?;
        if arguments.pairs.is_none() {
            pair_files::write_all(&pairs, &out.join("pairs"))?;
        }
    }
    output.answer(&report, || page.text());
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests;
