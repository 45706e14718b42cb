//! `tabula latency peers --pcl`: benchmark of the detection against PCL on the same scenes.
//!
//! PCL is run by an external harness, given by its path, that prints its times as CSV. The
//! detection is timed before and after it in the same run, which reveals a change of the
//! computer's speed.

use command_line::{Output, format_table};
use dataset::pcd;
use detection::{Config, Detection, DetectionInput, Execution, ScenePriors, Workspace, detect};
use point_cloud::OrganizedCloud;
use serde::Serialize;
use service::Failure;
use statistics::spread::Spread;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

/// Repetitions per scene; a tenth in a short run.
const N_REPETITIONS: usize = 40;
/// Name prefix of the harness's stages that are whole pipelines.
const WHOLE_FRAME: &str = "frame_";

/// Result: medians over the scenes of the medians over the repetitions.
#[derive(Serialize)]
struct PclComparison {
    n_scenes: usize,
    ours_ms: f64,
    /// Time of the detection after PCL over that before.
    drift: f64,
    peers: Vec<PclTiming>,
}

#[derive(Serialize)]
struct PclTiming {
    pipeline: String,
    threads: u32,
    ms: f64,
    /// Ratio of PCL's time to that of the detection.
    ratio: f64,
}

/// Times the detection on scenes (PCD) and compares it with the output of `harness`, a script
/// that times PCL.
///
/// # Errors
/// If a scene cannot be read, or the harness fails or prints malformed output.
pub(crate) fn run(
    harness: &Path,
    scenes: &[PathBuf],
    short: bool,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let n = if short {
        N_REPETITIONS / 10
    } else {
        N_REPETITIONS
    };
    output.print_status(&format!(
        "our detection on {}, {n} times each",
        scenes_counted(scenes.len())
    ));
    let before_ms = ours_ms(scenes, n)?;
    output.print_status("PCL on the same; the first time its harness is built, for minutes");
    let csv = run_harness(harness, scenes, n)?;
    let after_ms = ours_ms(scenes, n)?;
    let ours_ms = 0.5 * (before_ms + after_ms);
    let peers = parse(&csv).map_err(|sentence| failed(harness, &sentence))?;
    let comparison = PclComparison {
        n_scenes: scenes.len(),
        ours_ms,
        drift: after_ms / before_ms,
        peers: peers
            .into_iter()
            .map(|((pipeline, threads), ms)| {
                let ms = median(&ms);
                PclTiming {
                    pipeline,
                    threads,
                    ms,
                    ratio: ms / ours_ms,
                }
            })
            .collect(),
    };
    output.answer(&comparison, || text(&comparison));
    Ok(ExitCode::SUCCESS)
}

fn failed(harness: &Path, error: &dyn std::fmt::Display) -> Failure {
    let sentence = format!("the PCL harness {} failed: {error}", harness.display());
    Failure::general(sentence)
}

fn median(values: &[f64]) -> f64 {
    Spread::of(values).map_or(f64::NAN, |spread| spread.median)
}

/// Number of scenes as a phrase.
fn scenes_counted(n: usize) -> String {
    format!("{n} scene{}", if n == 1 { "" } else { "s" })
}

/// Median over the scenes of the median time of the detection, milliseconds.
fn ours_ms(scenes: &[PathBuf], n_repetitions: usize) -> Result<f64, Failure> {
    let (config, mut workspace) = (Config::default(), Workspace::default());
    let mut detection = Detection::default();
    let mut of_scenes = Vec::with_capacity(scenes.len());
    for path in scenes {
        let unusable =
            |error: &dyn std::fmt::Display| Failure::usage(format!("{}: {error}", path.display()));
        let scene = pcd::open(path).map_err(|error| unusable(&error))?;
        let cloud = OrganizedCloud::new(&scene.points, scene.width, scene.height)
            .map_err(|error| unusable(&error))?;
        let mut times_ms = Vec::with_capacity(n_repetitions);
        for _ in 0..n_repetitions {
            let frame = DetectionInput {
                cloud,
                up_in_camera: None,
                priors: ScenePriors::default(),
            };
            let begin = Instant::now();
            detect(
                &frame,
                &config,
                &mut workspace,
                &mut detection,
                Execution::default(),
            )
            .map_err(|error| unusable(&error))?;
            times_ms.push(begin.elapsed().as_secs_f64() * 1e3);
        }
        of_scenes.push(median(&times_ms));
    }
    Ok(median(&of_scenes))
}

/// Runs the harness and returns its output; its progress goes to our standard error.
fn run_harness(
    harness: &Path,
    scenes: &[PathBuf],
    n_repetitions: usize,
) -> Result<String, Failure> {
    let done = Command::new(harness)
        .args(["--native", "--only", WHOLE_FRAME, "--reps"])
        .arg(n_repetitions.to_string())
        .args(["--min-reps", "3", "--budget-ms", "2000"])
        .args(scenes)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| failed(harness, &error))?;
    if !done.status.success() {
        return Err(failed(harness, &format!("{}, see above", done.status)));
    }
    Ok(String::from_utf8_lossy(&done.stdout).into_owned())
}

/// Median time of each scene, by pipeline and number of threads.
fn parse(csv: &str) -> Result<BTreeMap<(String, u32), Vec<f64>>, String> {
    let mut lines = csv.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let column = |name: &str| {
        let place = header.iter().position(|column| *column == name);
        place.ok_or(format!("its output has no column {name}"))
    };
    let columns = [column("stage")?, column("threads")?, column("median_ms")?];
    let mut peers: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    for line in lines {
        let values: Vec<&str> = line.split(',').collect();
        let [stage, threads, ms] = columns.map(|column| values.get(column).copied());
        let numbers = threads
            .and_then(|n| n.parse().ok())
            .zip(ms.and_then(|ms| ms.parse().ok()));
        let (Some(stage), Some((threads, ms))) = (stage, numbers) else {
            return Err(format!("a line of its output is no measurement: {line}"));
        };
        peers
            .entry((stage.to_owned(), threads))
            .or_default()
            .push(ms);
    }
    if peers.is_empty() {
        return Err("it has measured nothing".into());
    }
    Ok(peers)
}

fn text(comparison: &PclComparison) -> String {
    let mut rows = vec![vec![
        "tabula".into(),
        "1".into(),
        format!("{:.2}", comparison.ours_ms),
        "1.0".into(),
    ]];
    rows.extend(comparison.peers.iter().map(|peer| {
        vec![
            format!("PCL {}", peer.pipeline.trim_start_matches(WHOLE_FRAME)),
            peer.threads.to_string(),
            format!("{:.2}", peer.ms),
            format!("{:.1}", peer.ratio),
        ]
    }));
    format!(
        "{}\nmedians over {}; ours after PCL took {:.2} times as long as before\n",
        format_table(&["detection", "threads", "median ms", "times ours"], &rows),
        scenes_counted(comparison.n_scenes),
        comparison.drift
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "scene,stage,threads,n_in,n_out,reps,median_ms,p99_ms,min_ms,note\n";

    #[test]
    fn harness_columns_are_found_by_name() {
        let csv =
            format!("{HEADER}a,frame_x,1,9,3,20,81.5,90,80,\nb,frame_x,1,9,3,20,79.5,90,80,\n");
        let peers = parse(&csv).unwrap();
        assert_eq!(peers[&("frame_x".to_owned(), 1)], [81.5, 79.5]);
    }

    #[test]
    fn malformed_harness_output_is_refused() {
        for (csv, word) in [
            ("", "no column"),
            (HEADER, "nothing"),
            (&format!("{HEADER}a,frame_x,one,9\n"), "a,frame_x,one,9"),
        ] {
            let error = parse(csv).unwrap_err();
            assert!(error.contains(word), "{error}");
        }
    }
}
