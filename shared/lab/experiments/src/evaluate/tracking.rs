//! `tabula evaluate tracking`: tracks against the truth of simulated scenes, and
//! tracks in recordings.

mod document;
mod recorded;
mod report;
mod scenes;
mod simulated;
mod tracker;
mod truth;
mod without_truth;

use super::failed;
use super::whole_file::{make_folder, write};
use crate::arguments::TrackingArguments;
use command_line::{Output, progress_bar};
use crossbeam::channel::unbounded;
use document::{Document, Run};
use evaluation::track_figure;
use evaluation::tracking_score::TrackingScore;
use indicatif::ProgressBar;
use recorded::Recording;
use scenes::Story;
use service::{Failure, exit_code};
use simulated::Told;
use std::path::Path;
use std::process::ExitCode;

/// Folder of the figures, within that of the results.
const PICTURES: &str = "tracks";

/// Plays scenes or a recording, and scores and draws the tracks.
pub(super) fn run(arguments: &TrackingArguments, output: &Output) -> Result<ExitCode, Failure> {
    let stories = match &arguments.dataset {
        None => scenes::built_in(),
        Some(path) => scenes::of_files(path)?,
    };
    match &arguments.dataset {
        Some(folder) if stories.is_empty() => run_recording(folder, arguments, output),
        _ if arguments.labels.is_some() => Err(Failure::new(
            exit_code::USAGE,
            "--labels names the objects of a recording without truth; the objects of scenes are \
             known",
        )),
        _ => run_stories(stories, arguments, output),
    }
}

fn run_stories(
    stories: Vec<Story>,
    arguments: &TrackingArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let stories = scenes::chosen(stories, &arguments.scene)?;
    make_folder(&arguments.out.join(PICTURES))?;
    let seeds = arguments.seed..arguments.seed.saturating_add(arguments.seeds);
    let jobs: Vec<(&Story, u64)> = stories
        .iter()
        .flat_map(|story| seeds.clone().map(move |seed| (story, seed)))
        .collect();
    let bar = progress_bar(jobs.len() as u64, "runs", output);
    let runs = play_all(&jobs, arguments, &bar);
    bar.finish_and_clear();
    finish(&runs?, arguments, output)
}

fn run_recording(
    folder: &Path,
    arguments: &TrackingArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let recording = Recording::open(folder)?;
    make_folder(&arguments.out.join(PICTURES))?;
    if !recording.has_truth()? {
        return without_truth::run(&recording, arguments, output);
    }
    let bar = progress_bar(recording.n_frames() as u64, "frames", output);
    let told = recording.play(|_| {
        bar.inc(1);
        Ok(())
    })?;
    bar.finish_and_clear();
    let run = scored(recording.name.clone(), None, told, arguments)?;
    finish(&[run], arguments, output)
}

/// Writes and prints what came out.
fn finish(
    runs: &[Run],
    arguments: &TrackingArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let document = Document::of(runs, arguments);
    let json = serde_json::to_string_pretty(&document).map_err(failed)?;
    write(&arguments.out.join("tracking.json"), json.as_bytes())?;
    let page = report::page(&document);
    write(&arguments.out.join("index.html"), page.as_bytes())?;
    output.answer(&document, || report::text(&document));
    Ok(ExitCode::SUCCESS)
}

/// Plays all, on as many threads as the machine runs at once; in the order of the
/// jobs.
fn play_all(
    jobs: &[(&Story, u64)],
    arguments: &TrackingArguments,
    bar: &ProgressBar,
) -> Result<Vec<Run>, Failure> {
    let n_threads = std::thread::available_parallelism().map_or(1, usize::from);
    let (sender, receiver) = unbounded();
    for job in jobs.iter().enumerate() {
        // The receiver is there.
        let _ = sender.send(job);
    }
    drop(sender);
    let work = || {
        let mut done = Vec::new();
        for (index, (story, seed)) in receiver.clone() {
            let run = simulated::play(story, *seed)
                .and_then(|told| scored(story.name.clone(), Some(*seed), told, arguments));
            let has_failed = run.is_err();
            done.push((index, run));
            bar.inc(1);
            if has_failed {
                break;
            }
        }
        done
    };
    let done: Result<Vec<_>, Failure> = std::thread::scope(|scope| {
        let n_workers = n_threads.min(jobs.len());
        let workers: Vec<_> = (0..n_workers).map(|_| scope.spawn(work)).collect();
        let done = workers.into_iter().map(std::thread::ScopedJoinHandle::join);
        done.map(|done| done.map_err(|_| failed("a run has panicked")))
            .collect()
    });
    let mut done: Vec<(usize, Result<Run, Failure>)> = done?.into_iter().flatten().collect();
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, run)| run).collect()
}

/// Scores and draws a run.
fn scored(
    scene: String,
    seed: Option<u64>,
    told: Told,
    arguments: &TrackingArguments,
) -> Result<Run, Failure> {
    let (score, matches) = TrackingScore::of(&told.frames);
    let (title, stem) = match seed {
        Some(seed) => (format!("{scene}, seed {seed}"), format!("{scene}-{seed}")),
        None => (scene.clone(), scene.clone()),
    };
    let picture = format!("{PICTURES}/{stem}.svg");
    let figure =
        track_figure::figure_with_ground_truth(&title, &told.frames, &matches, &told.names);
    let svg = figure.svg().map_err(failed)?;
    write(&arguments.out.join(&picture), svg.as_bytes())?;
    Ok(Run {
        scene,
        seed,
        n_frames: told.frames.len(),
        score,
        notes: told.notes,
        picture,
    })
}

#[cfg(test)]
mod tests;
