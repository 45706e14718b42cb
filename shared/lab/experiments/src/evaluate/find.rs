//! `tabula-lab evaluate find`: queries in words over the tracked objects of simulated scenes.

mod generated_queries;
mod query_file;
mod query_scene;
mod report;
mod report_page;

use crate::arguments::FindArguments;
use crate::output_files::{create_folder, write};
use command_line::{Output, progress_bar};
use query_scene::QueryScene;
use referring_expression::{Lexicon, WordNet, find};
use report::{AskedQuery, FindReport, QuerySource};
use service::Failure;
use std::process::ExitCode;
use std::time::Instant;

/// Query with the numbers of the objects that are meant.
#[derive(Debug, Clone, PartialEq)]
struct TrueQuery {
    words: String,
    /// Object numbers, ascending; none if nothing in the scene is meant.
    objects: Vec<u16>,
}

/// Simulates the scenes, asks all queries and writes the figures.
pub(super) fn run(arguments: &FindArguments, output: &Output) -> Result<ExitCode, Failure> {
    let file = query_file::read(arguments.queries.as_deref(), arguments.seed)?;
    create_folder(&arguments.out.join("scenes"))?;
    let wordnet = wordnet(arguments)?;
    let lexicon = wordnet.as_ref().map(|wordnet| wordnet as &dyn Lexicon);
    let bar = progress_bar(arguments.scenes, "scenes", output);
    let mut report = FindReport::new(arguments, lexicon.is_some());
    for number in 1..=arguments.scenes {
        let change = file.change(number)?;
        let mut scene = QueryScene::simulate(arguments.seed, number)?;
        scene.apply(&change)?;
        let picture = format!("scenes/{number:02}.png");
        write(&arguments.out.join(&picture), &scene.picture)?;
        // What is true of a scene with objects that are gone is only known to who wrote the file.
        let n_generated = if change.gone.is_empty() {
            arguments.queries_per_scene as usize
        } else {
            0
        };
        let generated = generated_queries::queries(&scene, n_generated);
        for query in generated {
            let asked = ask(&scene, number, query, QuerySource::Generated, lexicon)?;
            report.add(asked);
        }
        for query in file.of_scene(number) {
            let asked = ask(&scene, number, query.clone(), QuerySource::File, lexicon)?;
            report.add(asked);
        }
        report.add_scene(picture, &scene);
        bar.inc(1);
    }
    bar.finish_and_clear();
    report.finish();
    report_page::page(&report, |_| true).write(&arguments.out, "find.json", &report)?;
    output.answer(&report, || {
        let is_own_file = arguments.queries.is_some();
        let is_judged = |asked: &AskedQuery| is_own_file && asked.source == QuerySource::File;
        report_page::page(&report, |asked| !asked.is_right || is_judged(asked)).text()
    });
    Ok(ExitCode::SUCCESS)
}

/// WordNet of the arguments; `None` where it is not installed.
fn wordnet(arguments: &FindArguments) -> Result<Option<WordNet>, Failure> {
    let folder = &arguments.wordnet;
    if !folder.is_dir() {
        return Ok(None);
    }
    WordNet::open(folder).map(Some).map_err(Failure::general)
}

/// Asks a query and compares the answer with the truth.
fn ask(
    scene: &QueryScene,
    scene_number: u64,
    query: TrueQuery,
    source: QuerySource,
    lexicon: Option<&dyn Lexicon>,
) -> Result<AskedQuery, Failure> {
    let begin = Instant::now();
    let answer = find(&query.words, &scene.world(), lexicon);
    let ms = begin.elapsed().as_secs_f64() * 1e3;
    let answer = answer.map_err(|error| {
        Failure::usage(format!("the query {:?} is unusable: {error}", query.words))
    })?;
    Ok(AskedQuery::new(
        scene,
        scene_number,
        query,
        source,
        answer,
        ms,
    ))
}

#[cfg(test)]
mod tests;
