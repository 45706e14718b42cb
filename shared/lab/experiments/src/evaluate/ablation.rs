//! `tabula-lab evaluate ablation`: ablation study of descriptor variants under the open-ended
//! protocol, paired by seed.

mod report;
mod report_page;

use super::open_ended::{lesson_split, record_exclusions};
use super::recognition::{RecogniserFactory, RecognitionMethod};
use super::tabular_report::forest_figure;
use super::view_selection::ViewSelection;
use super::view_table::ViewTable;
use crate::arguments::{AblationArguments, AblationVariant};
use crate::output_files::create_folder;
use crate::parallel;
use clap::ValueEnum;
use command_line::Output;
use evaluation::open_ended::{self as teacher, Metrics, Protocol};
use report::AblationReport;
use service::Failure;
use std::process::ExitCode;

/// Reference variant of the paired comparisons.
const REFERENCE: AblationVariant = AblationVariant::Ours;

/// Runs of one variant, ordered by seed.
struct VariantRuns {
    variant: AblationVariant,
    runs: Vec<Metrics>,
}

/// Runs the study; writes figure, page and JSON report.
pub(super) fn run(arguments: &AblationArguments, output: &Output) -> Result<ExitCode, Failure> {
    let variants = chosen(&arguments.variants);
    let methods: Vec<RecognitionMethod> = variants
        .iter()
        .map(|&variant| RecognitionMethod::of_ablation(variant, arguments.bins))
        .collect();
    let catalogue = ViewSelection::open(&arguments.lessons.dataset, arguments.views_max)?;
    let (mut views, descriptions) = catalogue.describe_by(&methods, output)?;
    let protocol = Protocol {
        tau: arguments.lessons.tau,
        split: lesson_split(arguments.lessons.protocol, &views.labels),
        ..Protocol::default()
    };
    record_exclusions(&protocol, &mut views)?;
    create_folder(&arguments.lessons.out)?;
    let factories = methods.iter().zip(descriptions);
    let factories = factories.map(|(method, of_views)| method.recogniser_factory(&views, of_views));
    let factories: Vec<Box<dyn RecogniserFactory>> = factories.collect::<Result<_, _>>()?;
    let metrics = play_all(arguments, &protocol, &views, &factories, output)?;
    let of_variants = variants.into_iter().zip(metrics);
    let played: Vec<VariantRuns> = of_variants
        .map(|(variant, runs)| VariantRuns { variant, runs })
        .collect();
    write_all(arguments, &protocol, &views, &played, output)
}

/// Selected variants in the order of their declaration: all if none are named; always with the
/// reference.
fn chosen(named: &[AblationVariant]) -> Vec<AblationVariant> {
    let is_chosen = |variant: &&AblationVariant| {
        named.is_empty() || named.contains(variant) || **variant == REFERENCE
    };
    let variants = AblationVariant::value_variants().iter();
    variants.filter(is_chosen).copied().collect()
}

/// Metrics of all open-ended runs, by variant.
fn play_all(
    arguments: &AblationArguments,
    protocol: &Protocol,
    views: &ViewTable,
    factories: &[Box<dyn RecogniserFactory>],
    output: &Output,
) -> Result<Vec<Vec<Metrics>>, Failure> {
    let n_runs = arguments.runs as usize;
    let n_jobs = factories.len() * n_runs;
    let metrics = parallel::try_map(n_jobs, "runs", output, |job| {
        let mut recogniser = factories[job / n_runs].recogniser();
        let seed = arguments.lessons.seed.wrapping_add((job % n_runs) as u64);
        let run = teacher::run(recogniser.as_mut(), &views.labels, protocol, seed);
        run.map(|run| run.metrics()).map_err(Failure::general)
    })?;
    Ok(metrics.chunks(n_runs).map(<[Metrics]>::to_vec).collect())
}

fn write_all(
    arguments: &AblationArguments,
    protocol: &Protocol,
    views: &ViewTable,
    played: &[VariantRuns],
    output: &Output,
) -> Result<ExitCode, Failure> {
    let document = AblationReport::of(arguments, protocol, views, played);
    let rows = report_page::figure_rows(&document);
    let words = (
        "Mean GCA of each variant with its 95 % interval",
        "global classification accuracy",
    );
    let figure = forest_figure(&arguments.lessons.out, "gca.svg", words, &rows)?;
    let page = report_page::page(&document, figure);
    page.publish(&arguments.lessons.out, "ablation.json", &document, output)
}

#[cfg(test)]
mod tests;
