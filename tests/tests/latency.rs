//! `tabula latency`: measurement of a running daemon and of its own, budgets, comparison,
//! sweep and soak. No test asserts a speed.

use crate::daemon::{Daemon, Sandbox, WITH_CAMERA, eventually, program};
use crate::recorder::SceneRecorder;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Output, Stdio};

/// Number of frames of a short measurement.
const N_FRAMES: usize = 60;

/// Stages of a frame's critical path, which sum to the end-to-end latency.
const CHAIN: [&str; 9] = [
    "source",
    "transport",
    "gather_priors",
    "detection_queue",
    "detection",
    "detection_answer",
    "association",
    "objects",
    "publishing",
];

/// Latency stages of every object.
const OF_OBJECTS: [&str; 7] = [
    "dispatch",
    "actor_queue",
    "tracking",
    "description",
    "recognition",
    "key_view",
    "actor_answer",
];

fn latency(sandbox: &Sandbox, words: &[&str]) -> Output {
    let n_frames = N_FRAMES.to_string();
    let mut command = sandbox.command("tabula");
    command.args(["latency", "--json", "--warm-up", "5", "--frames", &n_frames]);
    command.args(words).output().unwrap()
}

fn document(output: &Output) -> Value {
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    serde_json::from_str(&printed).unwrap_or_else(|_| panic!("{output:?}"))
}

fn p50(stage: &Value) -> f64 {
    stage["p50"].as_f64().unwrap_or_else(|| panic!("{stage}"))
}

/// Process ids of the daemon.
fn pids(daemon: &Daemon<'_>) -> Vec<Value> {
    let status = daemon.ask(&["status"]);
    let processes = status["processes"].as_array().unwrap();
    processes
        .iter()
        .map(|process| process["pid"].clone())
        .collect()
}

#[test]
fn a_running_daemon_is_measured_and_goes_on() {
    let sandbox = Sandbox::new();
    // No object is late on a busy computer.
    let config = "[perception]\nactor_deadline_ms = 60000\n";
    std::fs::write(sandbox.home().join("tabula.toml"), config).unwrap();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let before = pids(&daemon);
    let measured = latency(&sandbox, &[]);
    assert!(measured.status.success(), "{measured:?}");
    let report = document(&measured);
    let stages = &report["stages"];
    for stage in CHAIN.iter().chain(&OF_OBJECTS) {
        let percentile = |name: &str| stages[stage][name].as_f64().unwrap();
        let ordered = ["p50", "p90", "p99", "max"].map(percentile);
        assert!(ordered.is_sorted(), "{stage}: {report}");
        let frames = stages[stage]["count"].as_u64().unwrap() as usize;
        assert!(frames >= N_FRAMES, "{stage}");
    }
    for off_path in [
        "generation",
        "release_wait",
        "sending",
        "label_hop",
        "trace_publishing",
    ] {
        assert!(stages[off_path].is_object(), "{off_path}: {report}");
    }
    let sum: f64 = CHAIN.iter().map(|stage| p50(&stages[stage])).sum();
    assert!(sum <= report["end_to_end_ms"]["max"].as_f64().unwrap());
    assert_eq!(report["sum_check"]["over"], 0, "{report}");
    assert!(report["sum_check"]["objects"].as_u64().unwrap() >= 4 * N_FRAMES as u64);
    assert_eq!(report["objects"]["max"], 5);
    let processes = report["processes"].as_array().unwrap();
    assert_eq!(processes.len(), 3, "{processes:?}");
    assert!(report["machine"]["fingerprint"].is_object());
    assert!(report["worst"].as_array().unwrap().len() == 10);
    assert_eq!(pids(&daemon), before, "no process was restarted");
    daemon.stop();
}

#[test]
fn latency_results_are_compared_with_budgets_and_earlier_results() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let folder = sandbox.home().join("results");
    let name = |file: &str| folder.join(file).to_str().unwrap().to_owned();
    let written = latency(&sandbox, &["--out", folder.to_str().unwrap()]);
    assert!(written.status.success(), "{written:?}");
    let timeline: Value = serde_json::from_slice(&read(name("timeline.json"))).unwrap();
    let events = timeline["traceEvents"].as_array().unwrap();
    assert!(events.iter().any(|event| event["name"] == "detection"));
    for picture in ["percentiles.svg", "over-time.svg"] {
        assert!(read(name(picture)).starts_with(b"<svg"), "{picture}");
    }
    let merged = daemon.ask(&[
        "latency",
        "merge",
        &name("latency.hlog"),
        &name("latency.hlog"),
    ]);
    let whole = merged.as_array().unwrap();
    let whole = whole
        .iter()
        .find(|row| row["stage"] == "end_to_end")
        .unwrap();
    assert_eq!(whole["count"].as_u64().unwrap() as usize % 2, 0);
    let report = name("report.json");
    let compared = daemon.ask(&["latency", "compare", &report, &report]);
    let verdicts = compared.as_array().unwrap();
    assert!(
        verdicts.iter().all(|c| c["verdict"] == "undecided"),
        "{compared}"
    );

    let budget = sandbox.home().join("budget.toml");
    let with_budget = |text: &str| {
        std::fs::write(&budget, text).unwrap();
        latency(&sandbox, &["--budget", budget.to_str().unwrap()])
    };
    let kept = with_budget("[end_to_end]\np50_ms = 10000");
    assert_eq!(document(&kept)["over_budget"], Value::Array(Vec::new()));
    assert!(kept.status.success());
    let exceeded = with_budget("[stages.detection]\np50_ms = 0.000001");
    assert_eq!(exceeded.status.code(), Some(7));
    assert_eq!(
        document(&exceeded)["over_budget"][0]["what"],
        "detection p50"
    );
    let wrong = with_budget("[stages.detecting]\np50_ms = 1");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("detecting"));
    daemon.stop();
}

fn read(path: impl AsRef<Path>) -> Vec<u8> {
    std::fs::read(path).unwrap()
}

#[test]
fn latency_of_an_own_daemon_starts_measures_and_stops_it() {
    let sandbox = Sandbox::new();
    let measured = latency(&sandbox, &["--source", "synthetic:2", "--rate", "20"]);
    assert!(measured.status.success(), "{measured:?}");
    let report = document(&measured);
    let period_ms = report["period_ms"].as_f64().unwrap();
    assert!((period_ms - 50.0).abs() < 0.1, "{period_ms}");
    let processes = report["processes"].as_array().unwrap();
    for process in processes {
        let pid = process["pid"].as_u64().unwrap();
        assert!(!Path::new(&format!("/proc/{pid}")).exists(), "{process}");
    }
    assert!(sandbox.shared_memory_files().is_empty());
}

#[test]
fn latency_measurement_that_is_killed_leaves_no_daemon() {
    let sandbox = Sandbox::new();
    let mut measuring = sandbox
        .command("tabula-latency")
        .args(["--source", "synthetic:0", "--frames", "100000"])
        // When killed, it cannot remove its daemon's home.
        .env("TMPDIR", sandbox.home())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let its_domain = format!("--domain=lat-{}", measuring.id());
    eventually("the daemon runs", || processes_with(&its_domain).len() == 5);
    measuring.kill().unwrap();
    measuring.wait().unwrap();
    eventually("the daemon has ended", || {
        processes_with(&its_domain).is_empty()
    });
    assert!(program("tabula-latency").exists());
}

#[test]
fn latency_measurement_interrupted_by_ctrl_c_reports_its_frames() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let measuring: Child = sandbox
        .command("tabula-latency")
        .args(["--json", "--warm-up", "0", "--frames", "1000000"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // It measures from the moment it has joined the domain.
    let n_files = sandbox.shared_memory_files().len();
    eventually("the measuring program has joined the domain", || {
        sandbox.shared_memory_files().len() > n_files
    });
    let frames = || {
        daemon
            .health("perception")
            .and_then(|health| health["frames"].as_u64())
    };
    let before = frames().unwrap();
    eventually("frames are measured", || frames() > Some(before + 60));
    let pid = Pid::from_raw(measuring.id().cast_signed()).unwrap();
    kill_process(pid, Signal::INT).unwrap();
    let output = measuring.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert!(document(&output)["frames"].as_u64().unwrap() > 0);
    daemon.stop();
}

#[test]
fn latency_of_unusable_sources_is_refused_with_a_sentence() {
    let sandbox = Sandbox::new();
    let wrong_source = latency(&sandbox, &["--source", "no-such-folder"]);
    assert_eq!(wrong_source.status.code(), Some(2), "{wrong_source:?}");
    let sentence = String::from_utf8_lossy(&wrong_source.stderr).into_owned();
    assert!(sentence.contains("no-such-folder"), "{sentence}");
    let no_report = latency(&sandbox, &["--baseline", "no-such-report.json"]);
    assert_eq!(no_report.status.code(), Some(2));
    let daemon = sandbox.start(&["--source", "synthetic:0", "--lockstep"]);
    let in_lockstep = latency(&sandbox, &[]);
    assert_eq!(in_lockstep.status.code(), Some(2));
    let sentence = String::from_utf8_lossy(&in_lockstep.stderr).into_owned();
    assert!(sentence.contains("lockstep"), "{sentence}");
    daemon.stop();
}

#[test]
fn sweep_measures_each_of_its_values() {
    let sandbox = Sandbox::new();
    let out = sandbox.home().join("sweeps");
    let sweep = |words: &[&str]| {
        let mut command = sandbox.command("tabula-latency");
        command.args(["sweep", "--json", "--frames", "20", "--out"]);
        document(&command.arg(&out).args(words).output().unwrap())
    };
    let objects = sweep(&["objects", "--values", "2,5"]);
    let rows = objects["rows"].as_array().unwrap();
    let seen: Vec<f64> = rows
        .iter()
        .map(|r| r["objects"].as_f64().unwrap())
        .collect();
    assert_eq!(seen, [2.0, 5.0], "{objects}");
    assert!(read(out.join("sweep-objects.svg")).starts_with(b"<svg"));
    let views = sweep(&["views", "--values", "300"]);
    assert_eq!(views["rows"][0]["value"], 300.0, "{views}");
    let recognition = &views["rows"][0]["stage_p50_ms"]["recognition"];
    assert!(recognition.is_number(), "{views}");
    let points = sweep(&["points", "--values", "80"]);
    assert!(
        points["rows"][0]["value"].as_f64().unwrap() > 500.0,
        "{points}"
    );
    let refused = sweep(&["objects", "--values", "0"]);
    assert_eq!(refused["exit_code"], 2);
    assert!(sandbox.shared_memory_files().is_empty());
}

/// Number of blocks that come and go, and of frames until all have been away.
const N_BLOCKS: usize = 12;
const N_FRAMES_PER_ROUND: u64 = 360;

/// Number of open files and threads of a process.
fn held(pid: u32) -> [usize; 2] {
    ["fd", "task"].map(|folder| {
        let entries = std::fs::read_dir(format!("/proc/{pid}/{folder}"));
        entries.unwrap().count()
    })
}

#[test]
fn soak_in_lockstep_holds_no_more_than_the_live_tracks_need() {
    let sandbox = Sandbox::new();
    let scenes = SceneRecorder::start(&sandbox);
    let source = format!("parade:{N_BLOCKS}");
    let daemon = sandbox.start(&["--source", &source, "--lockstep"]);
    let wait_for_round = |round: u64| {
        scenes.wait_for("a round of the parade is over", |scenes| {
            let last = scenes.last().map(|scene| scene.header.sequence);
            last >= Some(round * N_FRAMES_PER_ROUND)
        });
    };
    let pids = WITH_CAMERA.map(|process| daemon.pid(process).unwrap());
    let counts = || -> Vec<usize> {
        let held = pids.into_iter().flat_map(held);
        held.chain([sandbox.shared_memory_files().len()]).collect()
    };
    wait_for_round(2);
    let before = counts();
    wait_for_round(4);
    // A connection of a client may just be closing.
    eventually(
        "no more files, threads and shared memory than before",
        || {
            let is_grown = |(now, before): (&usize, &usize)| now > before;
            !counts().iter().zip(&before).any(is_grown)
        },
    );
    // A block that is away may leave a lost track, and a new one when it is back; each
    // track has one actor.
    let most = 2 * N_BLOCKS;
    let n_actors = daemon.health("perception").unwrap()["actors"].as_u64();
    assert!(n_actors.unwrap() <= most as u64, "{n_actors:?} actors");
    let (scenes, _) = scenes.stop();
    let n_objects = scenes
        .iter()
        .map(|scene| scene.header.n_objects_total)
        .max();
    assert!(n_objects.unwrap() <= most as u32, "{n_objects:?} tracks");
    daemon.stop();
}

/// Asserts that a soak reports no growth. Resident memory is judged only where the
/// retention limits are reached long before the end.
fn soak(n_frames: u32, rate_hz: u32) {
    let sandbox = Sandbox::new();
    let mut command = sandbox.command("tabula-latency");
    command.args(["soak", "--json", "--frames", &n_frames.to_string()]);
    let output = command
        .args(["--rate", &rate_hz.to_string()])
        .output()
        .unwrap();
    let run = document(&output);
    let frames = run["frames"].as_u64().unwrap();
    assert!(frames >= u64::from(n_frames), "{run}");
    let grown = run["grown"].as_array().unwrap();
    let sentences = grown
        .iter()
        .map(|growth| growth["sentence"].as_str().unwrap());
    let leaks: Vec<_> = sentences.filter(|s| !s.contains("p99")).collect();
    println!(
        "{frames} frames: {} dropped, grown: {grown:?}",
        run["dropped"]
    );
    assert!(leaks.is_empty(), "{leaks:?}");
    assert!(sandbox.shared_memory_files().is_empty());
}

#[test]
fn soak_reports_every_window_of_its_run() {
    let sandbox = Sandbox::new();
    let mut command = sandbox.command("tabula-latency");
    command.args(["soak", "--json", "--frames", "100", "--rate", "20"]);
    let run = document(&command.output().unwrap());
    assert!(run["frames"].as_u64().unwrap() >= 100, "{run}");
    let windows = run["windows"].as_array().unwrap();
    let n_frames: u64 = windows.iter().map(|w| w["frames"].as_u64().unwrap()).sum();
    assert_eq!(run["frames"], n_frames, "{run}");
    let is_whole = |window: &Value| window["processes"].as_array().unwrap().len() == 3;
    // The usage of a window is a difference; the first has nothing before it.
    assert!(windows[1..].iter().all(is_whole), "{run}");
    assert!(sandbox.shared_memory_files().is_empty());
}

#[test]
#[ignore = "long: half an hour"]
fn long_soak_of_two_hundred_thousand_frames_does_not_grow() {
    soak(200_000, 120);
}

/// Ids of the processes with a word in their command line.
fn processes_with(word: &str) -> Vec<u32> {
    let has_word = |pid: &u32| {
        let words = std::fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        words.split(|byte| *byte == 0).any(|w| w == word.as_bytes())
    };
    let all = std::fs::read_dir("/proc").unwrap();
    all.filter_map(|entry| entry.unwrap().file_name().to_str()?.parse().ok())
        .filter(has_word)
        .collect()
}

/// Longest time from a stop to braking, ms: the one time that a test asserts.
const BRAKING_LIMIT_MS: f64 = 250.0;

#[test]
fn arm_brakes_in_time_under_every_condition() {
    let sandbox = Sandbox::new();
    let out = tempfile::tempdir().unwrap();
    let mut command = sandbox.command("tabula");
    command.args(["latency", "stop", "--json", "--stops", "3", "--out"]);
    let output = command.arg(out.path()).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let document = document(&output);
    println!("{document:#}");
    let conditions = document["conditions"].as_array().unwrap();
    assert_eq!(conditions.len(), 10);
    for row in conditions {
        if let Some(reason) = row["skipped"].as_str() {
            eprintln!("SKIPPED: stops with {}: {reason}", row["condition"]);
            continue;
        }
        assert!(row["n_stops"].as_u64().unwrap() > 0, "{row}");
        assert_eq!(row["n_lost"], 0, "{row}");
        assert!(
            row["braking_ms"]["max"].as_f64().unwrap() < BRAKING_LIMIT_MS,
            "{row}"
        );
        let [braking, rest] =
            ["braking_ms", "rest_ms"].map(|key| row[key]["p50"].as_f64().unwrap());
        assert!(rest > braking, "{row}");
    }
    for file in ["stop.json", "stop.svg"] {
        assert!(out.path().join(file).is_file(), "{file}");
    }
}
