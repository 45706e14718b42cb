//! Liveness of sensor and scene: a camera that hangs or loses its folder is visible in every
//! answer, and works again in place when the cause has gone.

use crate::bad_input::good_scene;
use crate::daemon::{Daemon, Sandbox, eventually, send_signal, suspend};
use crate::faults::wait_for_frames;
use message::ProcessKind;
use rustix::process::Signal;
use serde_json::Value;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];
/// Watchdog that never ends a stopped camera during a test.
const WITHOUT_WATCHDOG: &str =
    "[run]\nwatchdog_s = 3600.0\nmemory_watchdog_s = 3600.0\nstartup_watchdog_s = 3600.0\n";

/// State and note of a process in `tabula status`.
fn state(daemon: &Daemon<'_>, process: ProcessKind) -> (String, String) {
    let health = daemon.health(process.word()).unwrap_or_default();
    let text = |key: &str| health[key].as_str().unwrap_or_default().to_owned();
    (text("state"), text("note"))
}

fn wait_for_state(daemon: &Daemon<'_>, process: ProcessKind, wanted: &str, note: &str) {
    eventually(&format!("{process:?} is {wanted}: {note}"), || {
        let (state, found) = state(daemon, process);
        state == wanted && found.contains(note)
    });
}

fn are_all(objects: &Value, state: &str) -> bool {
    let objects = objects.as_array().unwrap();
    !objects.is_empty() && objects.iter().all(|object| object["state"] == state)
}

/// Waits until `tabula objects` shows tracked objects of the present.
fn wait_for_fresh_objects(daemon: &Daemon<'_>) -> Value {
    let mut last = Value::Null;
    eventually("the objects are tracked", || {
        last = daemon.ask(&["objects"]);
        last["is_stale"] == false && are_all(&last["objects"], "tracked")
    });
    last
}

#[test]
fn hung_camera_makes_scene_and_world_stale_until_it_goes_on() {
    let sandbox = Sandbox::new();
    sandbox.configure(WITHOUT_WATCHDOG);
    let daemon = sandbox.start(&TABLE);
    let fresh = wait_for_fresh_objects(&daemon);
    assert_eq!(fresh["note"], "");
    let track = fresh["objects"][0]["track_id"].to_string();
    let camera = daemon.pid(ProcessKind::CAMERA).unwrap();
    suspend(camera);
    let begun = Instant::now();
    let mut objects = Value::Null;
    eventually("the scene is stale", || {
        objects = daemon.ask(&["objects"]);
        objects["is_stale"] == true
    });
    let stale_after = begun.elapsed();
    wait_for_state(
        &daemon,
        ProcessKind::PERCEPTION,
        "degraded",
        "no frame for ",
    );
    let degraded_after = begun.elapsed();
    eprintln!("stale after {stale_after:?}, perception degraded after {degraded_after:?}");

    assert!(are_all(&objects["objects"], "stale"), "{objects:#}");
    let age_s = objects["scene_age_s"].as_f64().unwrap();
    assert!(age_s >= 1.0, "{objects:#}");
    assert!(objects["objects"][0]["unseen_s"].as_f64().unwrap() >= age_s);
    assert!(
        objects["note"]
            .as_str()
            .unwrap()
            .contains("no frame was processed for")
    );
    let later = daemon.ask(&["objects"]);
    assert!(later["scene_age_s"].as_f64().unwrap() > age_s);
    assert_eq!(later["capture_stamp_ns"], objects["capture_stamp_ns"]);
    let asked = daemon.ask(&["ask", &track]);
    assert_eq!(asked["state"], "stale");
    assert!(asked["scene_age_s"].as_f64().unwrap() > age_s);
    let world = daemon.ask(&["world"]);
    assert!(
        world["is_stale"] == true && are_all(&world["objects"], "stale"),
        "{world:#}"
    );
    for command in [&["objects"][..], &["ask", &track], &["world"]] {
        let text = String::from_utf8(sandbox.tabula(command).stdout).unwrap();
        assert!(text.contains("STALE: no "), "{command:?}: {text}");
    }

    send_signal(camera, Signal::CONT).unwrap();
    wait_for_fresh_objects(&daemon);
    wait_for_state(&daemon, ProcessKind::PERCEPTION, "ready", "");
    eventually("the world is fresh", || {
        daemon.ask(&["world"])["is_stale"] == false
    });
    let log = daemon.log();
    assert_eq!(log.matches("the scene is stale until").count(), 1, "{log}");
    assert_eq!(log.matches("frames come again").count(), 1, "{log}");
    daemon.stop();
}

/// Recording in a folder that can be moved away.
struct MovableRecording {
    guard: tempfile::TempDir,
}

impl MovableRecording {
    fn new() -> Self {
        let recording = Self {
            guard: tempfile::tempdir().unwrap(),
        };
        std::fs::create_dir(recording.here()).unwrap();
        for name in ["1.pcd", "2.pcd"] {
            std::fs::write(recording.here().join(name), good_scene()).unwrap();
        }
        recording
    }

    fn here(&self) -> PathBuf {
        self.guard.path().join("recording")
    }

    fn away(&self) -> PathBuf {
        self.guard.path().join("away")
    }

    fn start<'a>(&self, sandbox: &'a Sandbox) -> Daemon<'a> {
        let source = self.here();
        sandbox.start(&[
            "--source",
            source.to_str().unwrap(),
            "--loop",
            "--rate",
            "10",
        ])
    }

    fn remove(&self) {
        std::fs::rename(self.here(), self.away()).unwrap();
    }

    fn restore(&self) {
        std::fs::rename(self.away(), self.here()).unwrap();
    }
}

#[test]
fn camera_whose_folder_is_away_for_a_moment_goes_on_in_place() {
    let (sandbox, recording) = (Sandbox::new(), MovableRecording::new());
    let daemon = recording.start(&sandbox);
    wait_for_frames(&daemon, ProcessKind::CAMERA);
    let camera = daemon.pid(ProcessKind::CAMERA);
    recording.remove();
    wait_for_state(
        &daemon,
        ProcessKind::CAMERA,
        "degraded",
        "cannot be read at present",
    );
    wait_for_state(
        &daemon,
        ProcessKind::PERCEPTION,
        "degraded",
        "no frame for ",
    );
    recording.restore();
    wait_for_frames(&daemon, ProcessKind::CAMERA);
    wait_for_state(&daemon, ProcessKind::CAMERA, "ready", "");
    wait_for_state(&daemon, ProcessKind::PERCEPTION, "ready", "");
    assert_eq!(daemon.pid(ProcessKind::CAMERA), camera, "{}", daemon.log());
    let log = daemon.log();
    assert_eq!(
        log.matches("trying again until it works").count(),
        1,
        "{log}"
    );
    assert_eq!(log.matches("works again after").count(), 1, "{log}");
    daemon.stop();
}

#[test]
fn camera_that_is_restarted_while_its_folder_is_away_waits_for_it() {
    let (sandbox, recording) = (Sandbox::new(), MovableRecording::new());
    let daemon = recording.start(&sandbox);
    wait_for_frames(&daemon, ProcessKind::CAMERA);
    let killed = daemon.pid(ProcessKind::CAMERA).unwrap();
    recording.remove();
    send_signal(killed, Signal::KILL).unwrap();
    let mut waiting = None;
    eventually("another camera waits for the folder", || {
        waiting = daemon.pid(ProcessKind::CAMERA);
        waiting != Some(killed) && state(&daemon, ProcessKind::CAMERA).0 == "degraded"
    });
    recording.restore();
    wait_for_state(&daemon, ProcessKind::CAMERA, "ready", "");
    wait_for_frames(&daemon, ProcessKind::CAMERA);
    assert_eq!(daemon.pid(ProcessKind::CAMERA), waiting, "{}", daemon.log());
    daemon.stop();
}

/// Sparse file in shared memory, removed at the end of the test.
struct SparseFile(PathBuf);

impl Drop for SparseFile {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

#[test]
fn sparse_file_of_others_does_not_keep_the_daemon_from_starting() {
    let sandbox = Sandbox::new();
    let name = format!("sparse-{}", std::process::id());
    let sparse = SparseFile(Path::new("/dev/shm").join(name));
    let file = std::fs::File::create(&sparse.0).unwrap();
    file.set_len(1 << 40).unwrap();
    let daemon = sandbox.start(&TABLE);
    drop(sparse);
    daemon.stop();
}

#[test]
fn segments_of_a_running_daemon_are_backed() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    wait_for_frames(&daemon, ProcessKind::PERCEPTION);
    let mut n_segments = 0;
    for name in sandbox.shared_memory_files() {
        // A file may go while it is looked at.
        let Ok(file) = std::fs::metadata(format!("/dev/shm/{name}")) else {
            continue;
        };
        if Path::new(&name).extension() == Some("data".as_ref()) {
            n_segments += 1;
            assert!(
                file.blocks() * 512 >= file.len(),
                "{name} is sparse: {file:?}"
            );
        }
    }
    assert!(n_segments > 10, "{n_segments}");
    daemon.stop();
}
