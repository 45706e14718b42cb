//! `tabula-lab evaluate tracking`: CLEAR MOT and identity scores of the tracks in simulated scenes
//! and recordings.

mod drift;
mod ground_truth;
mod person_tracks;
mod recorded_sequence;
mod report;
mod report_page;
mod resting_truth;
mod scenario;
pub(super) mod simulated_sequence;
mod small_text_file;
mod track_pixels;
pub(super) mod tracking_pipeline;
mod tracking_run;

use crate::arguments::TrackingArguments;
use crate::output_files::{create_folder, write_figure};
use crate::parallel;
use command_line::{Output, progress_bar};
use evaluation::track_figure;
use evaluation::tracking_score::TrackingScore;
use recorded_sequence::RecordedSequence;
use report::TrackingReport;
use scenario::Scenario;
use service::Failure;
use std::path::Path;
use std::process::ExitCode;
use tracking_run::{TrackedSequence, TrackingRun};

/// Frame rate of all sequences, hertz.
const RATE_HZ: f64 = 30.0;
/// Folder of the figures, inside the output folder.
const PICTURES: &str = "tracks";

/// Runs scenarios or a recording, and scores and draws the tracks.
pub(super) fn run(arguments: &TrackingArguments, output: &Output) -> Result<ExitCode, Failure> {
    let scenarios = match &arguments.dataset {
        None => scenario::built_in(),
        Some(path) => match path.to_str().and_then(scenario::generated) {
            Some(generated) if !path.exists() => vec![generated],
            _ => scenario::of_files(path)?,
        },
    };
    match &arguments.dataset {
        Some(folder) if scenarios.is_empty() => run_recording(folder, arguments, output),
        _ if arguments.labels.is_some() || arguments.truth.is_some() => Err(Failure::usage(
            "--labels and --truth describe the objects of a recording without truth; the objects \
             of scenes are known",
        )),
        _ => run_scenarios(scenarios, arguments, output),
    }
}

fn run_scenarios(
    scenarios: Vec<Scenario>,
    arguments: &TrackingArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let scenarios = scenario::chosen(scenarios, &arguments.scene)?;
    create_folder(&arguments.out.join(PICTURES))?;
    let seeds = arguments.seed..arguments.seed.saturating_add(arguments.seeds);
    let jobs: Vec<(&Scenario, u64)> = scenarios
        .iter()
        .flat_map(|scenario| seeds.clone().map(move |seed| (scenario, seed)))
        .collect();
    let runs = parallel::try_map(jobs.len(), "runs", output, |job| {
        let (scenario, seed) = jobs[job];
        let sequence = simulated_sequence::play(scenario, seed, arguments.hidden_people)?;
        scored(scenario.name.clone(), Some(seed), sequence, arguments)
    })?;
    finish(&runs, arguments, output)
}

fn run_recording(
    folder: &Path,
    arguments: &TrackingArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let recording = RecordedSequence::open(folder)?;
    create_folder(&arguments.out.join(PICTURES))?;
    if !recording.has_truth()? {
        let marks = resting_truth::marks(folder, arguments)?;
        return drift::run(&recording, marks.as_ref(), arguments, output);
    }
    let bar = progress_bar(recording.n_frames() as u64, "frames", output);
    let sequence = recording.play(|_| {
        bar.inc(1);
        Ok(())
    })?;
    bar.finish_and_clear();
    let run = scored(recording.name.clone(), None, sequence, arguments)?;
    finish(&[run], arguments, output)
}

/// Writes the JSON report and the page, and prints the report.
fn finish(
    runs: &[TrackingRun],
    arguments: &TrackingArguments,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let document = TrackingReport::of(runs, arguments);
    report_page::page(&document).publish(&arguments.out, "tracking.json", &document, output)
}

/// Scores one tracked sequence and draws its figure.
fn scored(
    scene: String,
    seed: Option<u64>,
    sequence: TrackedSequence,
    arguments: &TrackingArguments,
) -> Result<TrackingRun, Failure> {
    let (score, matches) = TrackingScore::of(&sequence.frames);
    let (title, stem) = match seed {
        Some(seed) => (format!("{scene}, seed {seed}"), format!("{scene}-{seed}")),
        None => (scene.clone(), scene.clone()),
    };
    let picture = format!("{PICTURES}/{stem}.svg");
    let figure =
        track_figure::figure_with_ground_truth(&title, &sequence.frames, &matches, &sequence.names);
    write_figure(&arguments.out, &picture, figure.svg())?;
    Ok(TrackingRun {
        scene,
        seed,
        n_frames: sequence.frames.len(),
        score,
        notes: sequence.notes,
        picture,
    })
}

#[cfg(test)]
mod tests;
