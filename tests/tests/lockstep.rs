//! Lockstep determinism: a recording gives bitwise identical scenes, except for the time
//! stamps of the stages.

use crate::daemon::{Daemon, Sandbox, eventually};
use crate::recorder::{RecordedScene, SceneRecorder};
use message::{ActorStamps, ProcessKind, StageStamps};
use rustix::process::Signal;
use std::path::Path;

/// Deterministic part of a scene. Printed numbers read back to the same bits, and NaN, an
/// absent distance, equals itself.
pub(crate) fn repeatable(scene: &RecordedScene) -> String {
    let mut scene = scene.clone();
    scene.header.session = 0;
    scene.header.stamps = StageStamps {
        capture_ns: scene.header.stamps.capture_ns,
        scheduled_ns: scene.header.stamps.scheduled_ns,
        ..StageStamps::default()
    };
    for object in &mut scene.items {
        object.stamps = ActorStamps::default();
    }
    format!("{scene:?}")
}

fn wait_for_the_end(daemon: &Daemon<'_>) {
    eventually("the recording ends", || {
        let camera = daemon.health(ProcessKind::CAMERA.word());
        camera.is_some_and(|camera| camera["state"] == "idle")
    });
}

/// Plays a source to its end and returns every scene; none may be dropped.
fn played(sandbox: &Sandbox, arguments: &[&str], n_frames: u64) -> Vec<RecordedScene> {
    let recorder = SceneRecorder::start(sandbox);
    let daemon = sandbox.start(&[arguments, &["--lockstep"]].concat());
    wait_for_the_end(&daemon);
    recorder.wait_for("the last scene is there", |scenes| {
        scenes
            .last()
            .is_some_and(|last| last.header.sequence == n_frames - 1)
    });
    let (scenes, n_lost) = recorder.stop();
    for process in [ProcessKind::PERCEPTION, ProcessKind::MEMORY] {
        let health = daemon.health(process.word()).unwrap();
        assert_eq!(health["frames_dropped"], 0, "{health:#}");
    }
    daemon.stop();
    assert_eq!(n_lost, 0);
    let sequences = scenes.iter().map(|scene| scene.header.sequence);
    assert!(
        sequences.eq(0..n_frames),
        "a frame is missing or was done twice"
    );
    let is_whole =
        |scene: &RecordedScene| scene.header.frames_dropped == 0 && scene.header.n_late == 0;
    assert!(scenes.iter().all(is_whole));
    scenes
}

/// Asserts that two homes with the same content give the same scenes.
fn check_repeatable(home: Option<&Path>, arguments: &[&str], n_frames: u64) -> Vec<RecordedScene> {
    let play = || {
        let sandbox = Sandbox::new();
        if let Some(home) = home {
            copy_folder(home, sandbox.home());
        }
        played(&sandbox, arguments, n_frames)
    };
    let (first, second) = (play(), play());
    for (first, second) in first.iter().zip(&second) {
        assert_eq!(repeatable(first), repeatable(second));
    }
    first
}

fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let (path, to) = {
            let entry = entry.unwrap();
            (entry.path(), to.join(entry.file_name()))
        };
        if path.is_dir() {
            copy_folder(&path, &to);
        } else {
            std::fs::copy(&path, &to).unwrap();
        }
    }
}

#[test]
fn lockstep_runs_of_the_synthetic_table_are_identical() {
    let scenes = check_repeatable(None, &["--source", "synthetic:0", "--to", "40"], 40);
    let last = scenes.last().unwrap();
    assert_eq!(last.items.len(), 5);
    assert!(
        last.items
            .windows(2)
            .all(|pair| pair[0].track_id < pair[1].track_id)
    );
}

#[test]
fn lockstep_runs_recognise_labels_from_the_same_frame_on() {
    let taught = Sandbox::new();
    let daemon = taught.start(&["--source", "synthetic:0"]);
    let objects = daemon.wait_for("all objects are tracked", |objects| objects.len() == 5);
    for (object, name) in objects.iter().zip(["a", "b", "c", "d", "e"]) {
        daemon.ask(&["teach", &object["track_id"].to_string(), name]);
    }
    daemon.stop();
    let arguments = ["--source", "synthetic:0", "--to", "40"];
    let scenes = check_repeatable(Some(taught.home()), &arguments, 40);
    let first = scenes.first().unwrap();
    assert!(
        first.items.iter().all(|object| object.label().is_some()),
        "{first:#?}"
    );
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn lockstep_runs_of_a_real_sequence_are_identical() {
    let folder = test_data::path("kitchen-sequence");
    let source = folder.to_str().unwrap();
    let arguments = ["--source", source, "--from", "100", "--to", "160"];
    let scenes = check_repeatable(None, &arguments, 60);
    assert!(scenes.iter().any(|scene| !scene.items.is_empty()));
}

#[test]
fn lockstep_source_continues_after_a_detection_is_lost() {
    const LOST: u64 = 7;
    let sandbox = Sandbox::with_faulty_perception();
    let configuration = format!("[perception]\nfault_panic_frame = {LOST}\n");
    std::fs::write(sandbox.home().join("tabula.toml"), configuration).unwrap();
    let recorder = SceneRecorder::start(&sandbox);
    let daemon = sandbox.start(&["--source", "synthetic:0", "--to", "20", "--lockstep"]);
    wait_for_the_end(&daemon);
    let (scenes, _) = recorder.stop();
    let sequences: Vec<u64> = scenes.iter().map(|scene| scene.header.sequence).collect();
    let all_others: Vec<u64> = (0..20).filter(|&frame| frame != LOST).collect();
    assert_eq!(sequences, all_others);
    assert!(daemon.log().contains("detection of frame 7"));
    daemon.stop();
}

#[test]
fn lockstep_source_continues_after_a_follower_is_killed() {
    let sandbox = Sandbox::new();
    let recorder = SceneRecorder::start(&sandbox);
    let daemon = sandbox.start(&["--source", "synthetic:0", "--lockstep"]);
    for follower in [ProcessKind::PERCEPTION, ProcessKind::MEMORY] {
        let newest = |scenes: &[RecordedScene]| scenes.last().map(|scene| scene.header.sequence);
        recorder.wait_for("scenes come", |scenes| newest(scenes) > Some(5));
        daemon.signal(follower, Signal::KILL);
        let mut before = None;
        recorder.is(|scenes| {
            before = newest(scenes);
            true
        });
        recorder.wait_for("scenes come again", |scenes| {
            newest(scenes) > before.map(|n| n + 20)
        });
    }
    let (scenes, _) = recorder.stop();
    let mut sequences: Vec<u64> = scenes.iter().map(|scene| scene.header.sequence).collect();
    sequences.dedup();
    let is_whole = sequences.windows(2).all(|pair| pair[1] == pair[0] + 1);
    assert!(is_whole, "a frame was left out: {sequences:?}");
    daemon.stop();
}
