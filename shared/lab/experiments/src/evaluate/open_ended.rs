//! `tabula-lab evaluate open-ended`: open-ended learning protocol with a simulated teacher.

mod question_log;
mod report;
mod report_page;

use super::recognition::RecogniserFactory;
use super::view_selection::read_and_describe;
use crate::arguments::{OpenEndedArguments, ViewProtocol};
use crate::evaluate::view_table::ViewTable;
use crate::output_files::{create_folder, write, write_figure};
use crate::parallel;
use command_line::Output;
use evaluation::open_ended::{
    self as teacher, LessonSplit, OpenEndedRun, Protocol, overview_svg, run_svg,
};
use evaluation::recogniser::LabelledView;
use report::OpenEndedReport;
use service::Failure;
use std::collections::{BTreeMap, BTreeSet};
use std::process::ExitCode;
use std::time::Instant;

/// Folder of the figures of single runs, inside the output folder.
const PICTURES: &str = "runs";

/// Run with the time of its questions.
struct TimedRun {
    run: OpenEndedRun,
    play_ms: f64,
}

/// Runs the protocol for all seeds; writes figures, log, page and JSON report.
pub(super) fn run(arguments: &OpenEndedArguments, output: &Output) -> Result<ExitCode, Failure> {
    let (mut views, factory) =
        read_and_describe(&arguments.lessons.dataset, &arguments.description, output)?;
    let protocol = protocol(arguments, &views);
    record_exclusions(&protocol, &mut views)?;
    create_folder(&arguments.lessons.out.join(PICTURES))?;
    let played = play_all(arguments, &protocol, &views, factory.as_ref(), output)?;
    let n_questions: usize = played.iter().map(|played| played.run.questions.len()).sum();
    let sum_ms: f64 = played.iter().map(|played| played.play_ms).sum();
    let ask_ms = sum_ms / n_questions.max(1) as f64;
    let runs: Vec<OpenEndedRun> = played.into_iter().map(|played| played.run).collect();
    draw(arguments, &protocol, &views, &runs)?;
    if let Some(path) = &arguments.log {
        write(path, question_log::csv(&runs, &views).as_bytes())?;
    }
    let document = OpenEndedReport::of(arguments, &protocol, &views, &runs, ask_ms);
    let page = report_page::page(&document);
    page.publish(&arguments.lessons.out, "open-ended.json", &document, output)
}

fn protocol(arguments: &OpenEndedArguments, views: &ViewTable) -> Protocol {
    Protocol {
        tau: arguments.lessons.tau,
        open_set_share: arguments.open_set_share,
        split: lesson_split(arguments.lessons.protocol, &views.labels),
        ..Protocol::default()
    }
}

/// Lesson split of the given protocol; without one, objects apart where at least half of the
/// categories have two known objects.
pub(super) fn lesson_split(protocol: Option<ViewProtocol>, labels: &[LabelledView]) -> LessonSplit {
    match protocol {
        Some(ViewProtocol::View) => LessonSplit::ByView,
        Some(ViewProtocol::InstanceDisjoint) => LessonSplit::InstanceDisjoint,
        None => {
            let mut objects: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
            for view in labels {
                objects
                    .entry(view.category)
                    .or_default()
                    .extend(view.instance);
            }
            let n_grouped = objects.values().filter(|known| known.len() > 1).count();
            if n_grouped > 0 && 2 * n_grouped >= objects.len() {
                LessonSplit::InstanceDisjoint
            } else {
                LessonSplit::ByView
            }
        }
    }
}

/// Name of a lesson split in reports, as on the command line.
pub(super) fn split_name(split: LessonSplit) -> &'static str {
    match split {
        LessonSplit::ByView => ViewProtocol::View.word(),
        LessonSplit::InstanceDisjoint => ViewProtocol::InstanceDisjoint.word(),
    }
}

/// Records the categories that the protocol excludes as omissions.
pub(super) fn record_exclusions(protocol: &Protocol, views: &mut ViewTable) -> Result<(), Failure> {
    let categories = teacher::usable_categories(protocol, &views.labels).map_err(Failure::usage)?;
    for (category, reason) in categories {
        let Some(reason) = reason else { continue };
        let of_category = views.labels.iter().filter(|view| view.category == category);
        let n_views = of_category.count();
        let name = &views.categories[category as usize];
        views.omissions.add(n_views, || match reason {
            teacher::Exclusion::TooFewViews { n_views } => format!(
                "the category {name} has {n_views} views, and {} are needed",
                protocol.n_views_at_start + 1
            ),
            teacher::Exclusion::TooFewInstances => {
                format!("the category {name} has no two objects that are known")
            }
        });
    }
    Ok(())
}

fn play_all(
    arguments: &OpenEndedArguments,
    protocol: &Protocol,
    views: &ViewTable,
    factory: &dyn RecogniserFactory,
    output: &Output,
) -> Result<Vec<TimedRun>, Failure> {
    parallel::try_map(arguments.runs as usize, "runs", output, |index| {
        let begin = Instant::now();
        let seed = arguments.lessons.seed.wrapping_add(index as u64);
        let mut recogniser = factory.recogniser();
        let run = teacher::run(recogniser.as_mut(), &views.labels, protocol, seed);
        let play_ms = begin.elapsed().as_secs_f64() * 1e3;
        run.map(|run| TimedRun { run, play_ms })
            .map_err(Failure::general)
    })
}

/// Draws the overview figure and one figure for each run.
fn draw(
    arguments: &OpenEndedArguments,
    protocol: &Protocol,
    views: &ViewTable,
    runs: &[OpenEndedRun],
) -> Result<(), Failure> {
    let out = &arguments.lessons.out;
    write_figure(out, "overview.svg", overview_svg(runs))?;
    runs.iter().try_for_each(|run| {
        let svg = run_svg(run, &views.categories, protocol.tau);
        write_figure(out, &picture(run.seed), svg)
    })
}

/// Path of a run's figure, relative to the output folder.
fn picture(seed: u64) -> String {
    format!("{PICTURES}/seed-{seed}.svg")
}

#[cfg(test)]
pub(super) mod tests;
