//! Replay of recordings: the same events in each lockstep replay, with any number of workers.

use crate::daemon::{Sandbox, eventually};
use crate::recordings::RecordingProcess;
use message::ProcessKind;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Records frames of a source; returns the file.
fn recorded(sandbox: &Sandbox, source: &[&str], n_frames: u32) -> PathBuf {
    let daemon = sandbox.start(source);
    let n_frames = n_frames.to_string();
    let options = ["--frames", &n_frames, "--foxglove-hz", "0"];
    let document = RecordingProcess::start(sandbox, &options).finished();
    daemon.stop();
    document["files"][0].as_str().unwrap().into()
}

/// Replays a recording in lockstep with a number of workers; returns digest and events.
fn replayed(sandbox: &Sandbox, file: &Path, workers: u32) -> (Value, String) {
    let config = sandbox.home().join("workers.toml");
    std::fs::write(&config, format!("[perception]\nworkers = {workers}\n")).unwrap();
    let events = sandbox.home().join("events.jsonl");
    let output = sandbox
        .command("tabula")
        .args(["--json", "replay"])
        .arg(file)
        .args(["--lockstep", "--events"])
        .arg(&events)
        .arg("--config")
        .arg(&config)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let digest = serde_json::from_slice(&output.stdout).unwrap();
    (digest, std::fs::read_to_string(events).unwrap())
}

/// Asserts that all replays have the same events; returns them.
fn check_repeatable(sandbox: &Sandbox, file: &Path, n_frames: u64) -> Vec<Value> {
    let (digest, events) = replayed(sandbox, file, 1);
    assert!(digest["n_frames"].as_u64() >= Some(n_frames), "{digest}");
    for workers in [1, 4, 4] {
        let (again, other) = replayed(sandbox, file, workers);
        let differing = events.lines().zip(other.lines()).find(|(a, b)| a != b);
        assert_eq!(differing, None, "{workers} workers");
        assert_eq!(again, digest, "{workers} workers");
    }
    let parse = |line: &str| serde_json::from_str(line).unwrap();
    events.lines().map(parse).collect()
}

/// Number of events of a kind.
fn count(events: &[Value], kind: &str) -> usize {
    events.iter().filter(|event| event["kind"] == kind).count()
}

#[test]
fn replays_of_a_simulated_scene_have_the_same_events() {
    let sandbox = Sandbox::new();
    let file = recorded(&sandbox, &["--source", "simulation:isolated"], 40);
    let events = check_repeatable(&sandbox, &file, 40);
    assert!(count(&events, "started") >= 3, "{}", events.len());
    assert!(count(&events, "object") > 100, "{}", events.len());
    // Assumptions are made when robot or people are not known: their states are replayed.
    let scenes = events.iter().filter(|event| event["kind"] == "scene");
    let unknown = scenes.filter(|scene| scene["content"]["assumptions"] != serde_json::json!([]));
    assert_eq!(unknown.count(), 0);
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn replays_of_a_real_sequence_have_the_same_events() {
    let sandbox = Sandbox::new();
    let folder = test_data::path("kitchen-sequence");
    let source = folder.to_str().unwrap();
    let source = ["--source", source, "--from", "100", "--rate", "15"];
    let file = recorded(&sandbox, &source, 40);
    let events = check_repeatable(&sandbox, &file, 40);
    assert!(count(&events, "started") > 0, "{}", events.len());
}

#[test]
fn replay_at_the_recorded_pace_shows_the_same_objects() {
    let sandbox = Sandbox::new();
    let file = recorded(&sandbox, &["--source", "synthetic:0"], 30);
    let second = Sandbox::new();
    let daemon = second.start(&["--source", file.to_str().unwrap()]);
    eventually("the recording ends", || {
        let camera = daemon.health(ProcessKind::CAMERA.word());
        camera.is_some_and(|camera| camera["state"] == "idle")
    });
    assert_eq!(daemon.objects().len(), 5);
    daemon.stop();
}

#[test]
fn replay_of_what_is_no_recording_is_refused() {
    let sandbox = Sandbox::new();
    let file = sandbox.home().join("a.mcap");
    std::fs::write(&file, "no recording").unwrap();
    let run = sandbox.tabula(&["replay", file.to_str().unwrap()]);
    let sentence = String::from_utf8(run.stderr).unwrap();
    assert!(
        !run.status.success() && sentence.contains("MCAP"),
        "{sentence}"
    );
    let run = sandbox.tabula(&["replay", "/nowhere"]);
    let sentence = String::from_utf8(run.stderr).unwrap();
    assert!(
        !run.status.success() && sentence.contains(".mcap"),
        "{sentence}"
    );
}
