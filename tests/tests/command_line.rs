//! Command line: the keys of JSON documents, the choice of the daemon,
//! and the doctor.

use crate::daemon::{Daemon, Sandbox, WATCHDOG, WITH_CAMERA, eventually, run_to_end, with_mounts};
use crate::documents::store_model;
use crate::skeleton::{id, wait_for_all};
use message::ProcessKind;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::process::{Command, Stdio};

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];

/// Type of a JSON value.
#[derive(Debug, Clone, Copy)]
pub(crate) enum JsonType {
    Count,
    Number,
    NumberOrNull,
    Text,
    TextOrNull,
    Truth,
    List,
    Vector(usize),
    VectorOrNull(usize),
    CountOrNull,
    Document(&'static [(&'static str, JsonType)]),
    DocumentOrNull(&'static [(&'static str, JsonType)]),
}
use JsonType::{
    Count, CountOrNull, Document, DocumentOrNull, List, Number, NumberOrNull, Text, TextOrNull,
    Truth, Vector, VectorOrNull,
};

impl JsonType {
    fn fits(self, value: &Value) -> bool {
        match self {
            Count => value.is_u64(),
            Number => value.is_number(),
            NumberOrNull => value.is_number() || value.is_null(),
            Text => value.is_string(),
            TextOrNull => value.is_string() || value.is_null(),
            Truth => value.is_boolean(),
            List => value.is_array(),
            VectorOrNull(length) => value.is_null() || Vector(length).fits(value),
            CountOrNull => value.is_u64() || value.is_null(),
            Document(shape) => {
                check_shape(value, shape);
                true
            }
            DocumentOrNull(shape) => value.is_null() || Document(shape).fits(value),
            Vector(length) => value.as_array().is_some_and(|values| {
                values.len() == length && values.iter().all(Value::is_number)
            }),
        }
    }
}

const OBJECTS: &[(&str, JsonType)] = &[
    ("objects", List),
    ("n_more", Count),
    ("session", Text),
    ("frame_sequence", Count),
    ("received_ns", Count),
    ("published_ns", Count),
    ("frames_dropped", Count),
    ("n_late", Count),
    ("surfaces", List),
    ("source_name", Text),
    ("capture_stamp_ns", Count),
    ("scene_age_s", Number),
    ("is_stale", Truth),
    ("note", Text),
    ("has_table", Truth),
    ("has_world_pose", Truth),
    ("camera", DocumentOrNull(CAMERA_POSE)),
    ("up", VectorOrNull(3)),
    ("rule", Text),
    ("assumptions", List),
    ("ignored", List),
    ("n_more_ignored", Count),
];
const SURFACE: &[(&str, JsonType)] = &[
    ("kind", Text),
    ("normal", Vector(3)),
    ("offset_m", Number),
    ("outline_m", List),
    ("n_samples", Count),
    ("track_ids", List),
];
const ASSUMPTION: &[(&str, JsonType)] = &[("name", Text), ("sentence", Text)];
const OBJECT: &[(&str, JsonType)] = &[
    ("track_id", Count),
    ("state", Text),
    ("label", TextOrNull),
    ("answer", Text),
    ("first_seen_ns", Count),
    ("last_seen_ns", Count),
    ("distance", NumberOrNull),
    ("probability", NumberOrNull),
    ("position_m", Vector(3)),
    ("orientation_xyzw", Vector(4)),
    ("size_m", Vector(3)),
    ("age_s", Number),
    ("unseen_s", Number),
    ("capture_stamp_ns", Count),
    ("scene_age_s", Number),
    ("n_points", Count),
    ("n_views", Count),
    ("mean_rgb", Vector(3)),
    ("colors", List),
    ("cut_by_image", Truth),
    ("memory_sequence", Count),
    ("covariance", DocumentOrNull(COVARIANCE)),
    ("velocity_m_s", VectorOrNull(3)),
    ("angular_velocity_rad_s", VectorOrNull(3)),
    ("view", CountOrNull),
    ("is_key_view", Truth),
    ("n_key_views", Count),
    ("n_sides", Count),
    ("categories", List),
    ("linked_to", CountOrNull),
    ("stamps", Document(STAMPS)),
];
const COVARIANCE: &[(&str, JsonType)] = &[("position_m2", Vector(6)), ("rotation_rad2", Vector(6))];
const CAMERA_POSE: &[(&str, JsonType)] =
    &[("position_m", Vector(3)), ("orientation_xyzw", Vector(4))];
const COLOR_SHARE: &[(&str, JsonType)] = &[("color", Text), ("share", Number)];
const FOUND: &[(&str, JsonType)] = &[
    ("query", Text),
    ("sentence", Text),
    ("matches", List),
    ("wants_one", Truth),
    ("understood", List),
    ("not_understood", List),
    ("remarks", List),
    ("scene_age_s", Number),
    ("is_stale", Truth),
];
const MATCH: &[(&str, JsonType)] = &[
    ("track_id", Count),
    ("score", Number),
    ("doubts", List),
    ("label", TextOrNull),
    ("answer", Text),
    ("state", Text),
    ("position_m", VectorOrNull(3)),
];
const QUESTION: &[(&str, JsonType)] = &[
    ("track_id", Count),
    ("kind", Text),
    ("uncertainty", Number),
    ("categories", List),
    ("position_m", Vector(3)),
    ("sentence", Text),
];
const WORD_USE: &[(&str, JsonType)] = &[("words", Text), ("meaning", Text)];
const NEAR_CATEGORY: &[(&str, JsonType)] = &[
    ("label", Text),
    ("distance", Number),
    ("probability", Number),
];
const STAMPS: &[(&str, JsonType)] = &[
    ("asked_ns", CountOrNull),
    ("begun_ns", CountOrNull),
    ("described_ns", CountOrNull),
    ("recognised_ns", CountOrNull),
    ("answered_ns", CountOrNull),
];
const LEARNED: &[(&str, JsonType)] = &[
    ("sequence", Count),
    ("category", Text),
    ("n_views_changed", Count),
];
const CATEGORY: &[(&str, JsonType)] = &[
    ("category", Text),
    ("n_views", Count),
    ("bytes", Count),
    ("last_taught_ns", Count),
];
const PROCESS: &[(&str, JsonType)] = &[
    ("process", Text),
    ("pid", Count),
    ("state", Text),
    ("stamp_ns", Count),
    ("started_ns", Count),
    ("uptime_s", Number),
    ("frames", Count),
    ("frames_dropped", Count),
    ("frames_late", Count),
    ("allocated_bytes", Count),
    ("resident_bytes", Count),
    ("shared_memory_bytes", Count),
    ("restarts", Count),
    ("actors", Count),
    ("abandoned", Count),
    ("note", Text),
];
const EXPECTED_PROCESS: &[(&str, JsonType)] = &[
    ("process", Text),
    ("pid", CountOrNull),
    ("state", Text),
    ("since_ns", Count),
    ("n_ends", Count),
    ("cause", Text),
    ("supervisor", Text),
    ("trouble", Text),
];
const STARTED: &[(&str, JsonType)] = &[
    ("domain", Text),
    ("home", Text),
    ("run_folder", Text),
    ("processes", List),
];
const STARTED_PROCESS: &[(&str, JsonType)] = &[("process", Text), ("pid", Count)];
const FINDING: &[(&str, JsonType)] = &[("check", Text), ("verdict", Text), ("sentence", Text)];
const DOCUMENT: &[(&str, JsonType)] = &[
    ("kind", Text),
    ("name", Text),
    ("media_type", Text),
    ("bytes", Count),
    ("digest", Text),
    ("author", Text),
    ("decided_ns", Count),
    ("sequence", Count),
];
const MODEL: &[(&str, JsonType)] = &[
    ("name", Text),
    ("bytes", Count),
    ("author", Text),
    ("decided_ns", Count),
    ("sequence", Count),
    ("extents_m", Vector(3)),
    ("n_vertices", Count),
    ("n_triangles", Count),
    ("is_closed_loop", Truth),
    ("completeness", Number),
    ("missing", List),
    ("unseen_directions", List),
    ("views", List),
    ("refused", List),
    ("versions", List),
];
const MODEL_VIEW: &[(&str, JsonType)] = &[
    ("captured_ns", Count),
    ("n_points", Count),
    ("new_surface_share", Number),
    ("position_m", Vector(3)),
    ("orientation_xyzw", Vector(4)),
];
const REFUSED_VIEW: &[(&str, JsonType)] = &[("captured_ns", Count), ("reason", Text)];
const DOCUMENT_VERSION: &[(&str, JsonType)] = &[
    ("sequence", Count),
    ("decided_ns", Count),
    ("author", Text),
    ("bytes", CountOrNull),
    ("digest", TextOrNull),
];
const MODEL_EXPORT: &[(&str, JsonType)] = &[
    ("file", Text),
    ("bytes", Count),
    ("n_vertices", Count),
    ("n_triangles", Count),
    ("sequence", Count),
];
const ERROR: &[(&str, JsonType)] = &[("error", Text), ("exit_code", Count)];

/// Asserts that the document has exactly these keys, with values of these types.
pub(crate) fn check_shape(document: &Value, shape: &[(&str, JsonType)]) {
    let object = document
        .as_object()
        .unwrap_or_else(|| panic!("{document} is no object"));
    let mut given: Vec<_> = object.keys().map(String::as_str).collect();
    let mut expected: Vec<_> = shape.iter().map(|(key, _)| *key).collect();
    given.sort_unstable();
    expected.sort_unstable();
    assert_eq!(given, expected, "{document}");
    for (key, kind) in shape {
        assert!(kind.fits(&object[*key]), "{key} is no {kind:?}: {document}");
    }
}

/// Asserts that the list is not empty and all its documents have this shape.
pub(crate) fn check_list(list: &Value, shape: &[(&str, JsonType)]) {
    let list = list.as_array().unwrap();
    assert!(!list.is_empty());
    for document in list {
        check_shape(document, shape);
    }
}

#[test]
fn commands_answer_with_exactly_the_documented_keys() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    check_shape(&daemon.started, STARTED);
    check_list(&daemon.started["processes"], STARTED_PROCESS);
    assert_eq!(daemon.started["domain"], json!(sandbox.domain.to_string()));
    assert_eq!(daemon.started["home"], json!(sandbox.home()));

    let track = id(&wait_for_all(&daemon, 0)[0]);
    let objects = daemon.ask(&["objects"]);
    check_shape(&objects, OBJECTS);
    check_list(&objects["objects"], OBJECT);
    check_list(&objects["assumptions"], ASSUMPTION);
    check_list(&objects["surfaces"], SURFACE);
    check_list(&objects["objects"][0]["colors"], COLOR_SHARE);
    let unknown = daemon.ask(&["ask", &track]);
    check_shape(&unknown, OBJECT);
    assert_eq!(
        (&unknown["label"], &unknown["distance"]),
        (&Value::Null, &Value::Null)
    );

    let question = daemon.ask(&["ask", "--teach-me"]);
    check_shape(&question, &[("question", DocumentOrNull(QUESTION))]);
    let none = daemon.ask(&["categories"]);
    assert_eq!(none, json!({"categories": []}));
    let taught = daemon.ask(&["teach", &track, "mug", "--author", "Ada"]);
    check_shape(&taught, LEARNED);
    let corrected = daemon.ask(&["correct", &track, "bowl"]);
    check_shape(&corrected, LEARNED);
    assert!(corrected["sequence"].as_u64() > taught["sequence"].as_u64());
    let categories = daemon.ask(&["categories"]);
    check_shape(&categories, &[("categories", List)]);
    check_list(&categories["categories"], CATEGORY);
    let known = daemon.ask(&["ask", &track]);
    check_shape(&known, OBJECT);
    assert_eq!(known["label"], "bowl", "{known}");
    assert!(known["distance"].is_number(), "{known}");
    check_list(&known["categories"], NEAR_CATEGORY);
    assert_eq!(known["categories"][0]["label"], "bowl");
    assert_eq!(known["categories"][0]["distance"], known["distance"]);
    let found = daemon.ask(&["find", "the", "bowl"]);
    check_shape(&found, FOUND);
    check_list(&found["matches"], MATCH);
    check_list(&found["understood"], WORD_USE);
    assert_eq!(
        found["matches"][0]["track_id"].to_string(),
        track,
        "{found}"
    );
    check_shape(&daemon.ask(&["forget", "bowl", "--author", "Ada"]), LEARNED);

    let status = daemon.ask(&["status"]);
    check_shape(&status, &[("processes", List), ("expected", List)]);
    check_list(&status["processes"], PROCESS);
    check_list(&status["expected"], EXPECTED_PROCESS);
    assert_eq!(
        status["processes"].as_array().unwrap().len(),
        WITH_CAMERA.len()
    );
    let findings = daemon.ask(&["doctor"]);
    check_shape(&findings, &[("findings", List)]);
    check_list(&findings["findings"], FINDING);
    daemon.stop();
}

#[test]
fn document_commands_answer_with_exactly_the_documented_keys() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    assert_eq!(daemon.ask(&["model", "list"]), json!({"models": []}));
    let put = daemon.ask(&["knowledge", "put", "note", "/etc/hostname"]);
    check_shape(&put, LEARNED);
    let listed = daemon.ask(&["knowledge", "list"]);
    check_shape(&listed, &[("documents", List)]);
    check_list(&listed["documents"], DOCUMENT);

    store_model(&sandbox, "box");
    let listed = daemon.ask(&["model", "list"]);
    check_shape(&listed, &[("models", List)]);
    check_list(&listed["models"], DOCUMENT);
    assert_eq!(listed["models"].as_array().unwrap().len(), 1, "{listed}");
    let model = daemon.ask(&["model", "show", "box"]);
    check_shape(&model, MODEL);
    check_list(&model["views"], MODEL_VIEW);
    check_list(&model["refused"], REFUSED_VIEW);
    check_list(&model["versions"], DOCUMENT_VERSION);
    assert_eq!(model["missing"][0], "the underside");
    assert!(Vector(3).fits(&model["unseen_directions"][0]), "{model}");
    let file = sandbox.home().join("box.ply");
    let export = ["model", "export", "box", "--out", file.to_str().unwrap()];
    let exported = daemon.ask(&export);
    check_shape(&exported, MODEL_EXPORT);
    let length = std::fs::metadata(&file).unwrap().len();
    assert_eq!(exported["bytes"], json!(length));
    check_shape(&daemon.ask(&["model", "forget", "box"]), LEARNED);
    daemon.stop();
}

#[test]
fn failures_are_documents_with_their_exit_code() {
    let sandbox = Sandbox::new();
    let check = |arguments: &[&str], code: i32| {
        let output = sandbox.tabula(&[arguments, &["--json"]].concat());
        assert_eq!(
            output.status.code(),
            Some(code),
            "{arguments:?}: {output:?}"
        );
        let document: Value = serde_json::from_slice(&output.stdout).unwrap();
        check_shape(&document, ERROR);
        assert_eq!(document["exit_code"], json!(code));
        let sentence = document["error"].as_str().unwrap();
        let printed = String::from_utf8(output.stderr).unwrap();
        assert!(
            printed.ends_with(&format!("tabula: {sentence}\n")),
            "{printed}"
        );
    };
    for command in [
        &["objects"][..],
        &["ask", "1"],
        &["teach", "1", "mug"],
        &["status"],
    ] {
        check(command, 3);
    }
    check(&["run", "--source", "/nowhere"], 2);
    let daemon = sandbox.start(&TABLE);
    wait_for_all(&daemon, 0);
    check(&["ask", "999999"], 4);
    check(&["teach", "999999", "mug"], 4);
    check(&["forget", "unicorn"], 4);
    daemon.stop();
}

/// Lines of `tabula objects --watch` until it is interrupted after `n_lines`.
fn watched(daemon: &Daemon<'_>, arguments: &[&str], n_lines: usize) -> Vec<String> {
    let mut command = daemon.sandbox.command("tabula");
    command
        .args(["objects", "--watch"])
        .args(arguments)
        .stdout(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut read: Vec<String> = lines.by_ref().take(n_lines).map(Result::unwrap).collect();
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    read.extend(lines.map(Result::unwrap));
    let mut status = None;
    eventually("the watch ends", || {
        status = child.try_wait().unwrap();
        status.is_some()
    });
    assert!(status.unwrap().success(), "{status:?}");
    read
}

#[test]
fn watch_prints_text_or_json_lines_until_interrupted() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    let lines = watched(&daemon, &["--json"], 4);
    let mut frames = Vec::new();
    for line in &lines {
        let document: Value = serde_json::from_str(line).unwrap();
        check_shape(&document, OBJECTS);
        check_list(&document["objects"], OBJECT);
        frames.push(document["frame_sequence"].as_u64().unwrap());
    }
    assert!(
        frames.is_sorted() && frames.first() < frames.last(),
        "{frames:?}"
    );

    let lines = watched(&daemon, &[], 3 * (objects.len() + 2));
    assert!(
        lines
            .iter()
            .filter(|line| line.starts_with("id  label"))
            .count()
            >= 2,
        "{lines:#?}"
    );
    for object in &objects {
        let begin = format!("{} ", id(object));
        assert!(
            lines.iter().any(|line| line.starts_with(&begin)),
            "{begin} not in {lines:#?}"
        );
    }
    assert!(
        lines.iter().any(|line| line.contains("of synthetic:0")),
        "{lines:#?}"
    );
    assert!(
        !lines.concat().contains('\u{1b}'),
        "no terminal codes in a pipe"
    );
    daemon.stop();
}

#[test]
fn watch_waits_for_a_restarted_daemon() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    wait_for_all(&daemon, 0);
    let mut command = sandbox.command("tabula");
    command
        .args(["objects", "--watch", "--json"])
        .stdout(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.next().is_some());
    daemon.signal(ProcessKind::MEMORY, Signal::KILL);
    // More lines than were under way when the memory was killed.
    assert_eq!(lines.by_ref().take(20).count(), 20);
    kill_process(Pid::from_child(&child), Signal::TERM).unwrap();
    lines.for_each(drop);
    assert!(child.wait().unwrap().success());
    daemon.stop();
}

#[test]
fn flags_and_environment_choose_the_same_daemon() {
    let sandbox = Sandbox::new();
    let domain = sandbox.domain.to_string();
    let home = sandbox.home().to_str().unwrap().to_owned();
    let by_flags = |arguments: &[&str]| {
        let mut command = sandbox.command("tabula");
        command
            .env("TABULA_DOMAIN", "elsewhere")
            .env("TABULA_HOME", "/nowhere");
        command
            .args(["--domain", &domain, "--home", &home, "--json"])
            .args(arguments);
        command
    };
    let mut run = by_flags(&["run"])
        .args(TABLE)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(run.stdout.take().unwrap())
        .read_line(&mut line)
        .unwrap();
    let started: Value = serde_json::from_str(&line).unwrap();
    assert_eq!(started["domain"], json!(domain));
    assert_eq!(started["home"], json!(home));
    assert!(sandbox.home().join("perceptual-memory").is_dir());

    let answer = |output: std::process::Output| -> Value {
        assert!(output.status.success(), "{output:?}");
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let by_environment = answer(sandbox.tabula(&["status", "--json"]));
    let pids = |status: &Value| -> Vec<Value> {
        status["processes"]
            .as_array()
            .unwrap()
            .iter()
            .map(|one| one["pid"].clone())
            .collect()
    };
    let by_flag = answer(by_flags(&["status"]).output().unwrap());
    assert_eq!(pids(&by_environment), pids(&by_flag));
    // Flags may stand behind the command as well.
    let mut behind = sandbox.command("tabula");
    behind
        .env("TABULA_DOMAIN", "elsewhere")
        .args(["status", "--json", "--domain", &domain]);
    assert_eq!(pids(&answer(behind.output().unwrap())), pids(&by_flag));

    kill_process(Pid::from_child(&run), Signal::INT).unwrap();
    assert!(run.wait().unwrap().success());
    assert_eq!(sandbox.shared_memory_files(), Vec::<String>::new());
}

#[test]
fn domains_isolate_two_daemons() {
    // The second one's name begins like the first one's, in one run folder.
    let sandbox = Sandbox::new();
    let other = sandbox.neighbour();
    let daemon = sandbox.start(&TABLE);
    let neighbour = other.start(&["--source", "synthetic:1", "--rate", "10"]);
    let objects = wait_for_all(&daemon, 0);
    wait_for_all(&neighbour, 1);
    daemon.ask(&["teach", &id(&objects[0]), "thing"]);
    assert_eq!(neighbour.ask(&["categories"]), json!({"categories": []}));
    assert_eq!(daemon.ask(&["objects"])["source_name"], "synthetic:0");
    assert_eq!(neighbour.ask(&["objects"])["source_name"], "synthetic:1");
    let before = neighbour.pids();
    daemon.stop();
    wait_for_all(&neighbour, 1);
    assert_eq!(neighbour.pids(), before);
    let (code, _) = neighbour.refused(&["forget", "thing"]);
    assert_eq!(code, 4);
    neighbour.stop();
}

fn mode(path: &Path) -> u32 {
    std::fs::metadata(path).unwrap().mode() & 0o777
}

#[test]
fn control_socket_permissions_are_owner_and_group() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    assert_eq!(
        mode(&sandbox.run_folder().control_socket(&sandbox.domain)),
        0o660
    );
    // The group may enter it where there is a group `tabula`.
    let folder = mode(&sandbox.run_folder().domain_folder(&sandbox.domain));
    assert_eq!(folder & !0o050, 0o700, "{folder:o}");
    daemon.stop();
}

/// Names of the checks of `tabula doctor`.
const CHECKS: [&str; 14] = [
    "shared memory",
    "largest services",
    "open files",
    "domain",
    "stale nodes",
    "control socket",
    "processes",
    "configuration",
    "depth noise",
    "data folder",
    "ports",
    "libfreenect",
    "fakenect",
    "kinect",
];

/// Findings of the doctor by check, and its exit code.
fn examined(command: &mut Command) -> (Vec<(String, String, String)>, i32) {
    let output = run_to_end(command.args(["doctor", "--json"]), WATCHDOG);
    (findings(&output.stdout), output.status.code().unwrap())
}

fn findings(document: &[u8]) -> Vec<(String, String, String)> {
    let document: Value = serde_json::from_slice(document).unwrap();
    let text = |finding: &Value, key: &str| finding[key].as_str().unwrap().to_owned();
    let findings = document["findings"].as_array().unwrap().iter();
    findings
        .map(|finding| {
            (
                text(finding, "check"),
                text(finding, "verdict"),
                text(finding, "sentence"),
            )
        })
        .collect()
}

fn of_check<'a>(findings: &'a [(String, String, String)], check: &str) -> (&'a str, &'a str) {
    let found = findings.iter().find(|(name, ..)| name == check).unwrap();
    (&found.1, &found.2)
}

#[test]
fn doctor_lists_every_check_and_succeeds_without_failures() {
    let sandbox = Sandbox::new();
    let check = |running: bool| {
        let (findings, code) = examined(&mut sandbox.command("tabula"));
        let names: Vec<_> = findings.iter().map(|(name, ..)| name.as_str()).collect();
        assert_eq!(names, CHECKS);
        let has_failed = findings.iter().any(|(_, verdict, _)| verdict == "failure");
        assert_eq!(code, i32::from(has_failed), "{findings:#?}");
        assert!(!has_failed, "{findings:#?}");
        let (_, domain) = of_check(&findings, "domain");
        assert_eq!(domain.contains("tabula-memory ("), running, "{domain}");
        let (verdict, socket) = of_check(&findings, "control socket");
        assert_eq!(verdict, "ok", "{socket}");
        assert_eq!(
            socket.contains("4 of 4 processes report"),
            running,
            "{socket}"
        );
        let text = sandbox.tabula(&["doctor"]);
        let text = String::from_utf8(text.stdout).unwrap();
        for (line, name) in text.lines().zip(CHECKS) {
            assert!(line.contains(&format!("  {name}: ")), "{line}");
        }
        assert_eq!(text.lines().count(), CHECKS.len(), "{text}");
    };
    check(false);
    assert!(
        !sandbox.run_folder().domain_folder(&sandbox.domain).exists(),
        "looking makes nothing"
    );
    let daemon = sandbox.start(&TABLE);
    wait_for_all(&daemon, 0);
    check(true);
    daemon.stop();
}

/// Scene of a table that a simulated Kinect sees from afar.
const FAR_TABLE: &str = "
seed = 11
[camera]
distance_m = 1.7
[[object]]
category = 'bottle'
position_m = [-0.12, 0.20]
";

#[test]
fn doctor_tells_the_noise_measured_on_the_table() {
    let sandbox = Sandbox::new();
    let sentence = || {
        let (findings, _) = examined(&mut sandbox.command("tabula"));
        let (verdict, sentence) = of_check(&findings, "depth noise");
        (verdict.to_owned(), sentence.to_owned())
    };
    let (verdict, alone) = sentence();
    assert_eq!(verdict, "ok", "{alone}");
    assert!(alone.contains("no daemon runs"), "{alone}");
    let scene = sandbox.home().join("far.toml");
    std::fs::write(&scene, FAR_TABLE).unwrap();
    let source = format!("simulation:{}", scene.display());
    let config = sandbox.home().join("tabula.toml");
    for (law, verdict, words) in [
        ("kinect-v1", "ok", "times the configured law kinect-v1"),
        ("time-of-flight", "warning", "depth_noise = \"kinect-v1\""),
    ] {
        std::fs::write(&config, format!("[perception]\ndepth_noise = \"{law}\"\n")).unwrap();
        let daemon = sandbox.start(&["--source", &source, "--rate", "10"]);
        let is_measured = || !sentence().1.contains("not measured yet");
        eventually("the noise is measured", is_measured);
        let (found, told) = sentence();
        assert_eq!(found, verdict, "{told}");
        assert!(told.contains(words), "{told}");
        daemon.stop();
    }
}

#[test]
fn doctor_fails_when_the_daemon_could_not_run() {
    let sandbox = Sandbox::new();
    let file = sandbox.home().join("file");
    std::fs::write(&file, "not a folder").unwrap();
    for home in [file.clone(), file.join("below")] {
        let (findings, code) = examined(sandbox.command("tabula").arg("--home").arg(&home));
        let (verdict, sentence) = of_check(&findings, "data folder");
        assert_eq!((verdict, code), ("failure", 1), "{sentence}");
        assert!(
            sentence.contains("file") && sentence.contains("--home DIR"),
            "{sentence}"
        );
    }
    let own = sandbox.command("tabula");
    let mut few = Command::new("sh");
    few.args(["-c", "ulimit -Sn 100; ulimit -Hn 100; exec \"$@\"", "sh"])
        .arg(own.get_program())
        .envs(
            own.get_envs()
                .filter_map(|(name, value)| Some((name, value?))),
        );
    let (findings, code) = examined(&mut few);
    let (verdict, sentence) = of_check(&findings, "open files");
    assert_eq!((verdict, code), ("failure", 1), "{sentence}");
    assert!(sentence.contains("hard limit is 100"), "{sentence}");
}

/// Needs root: the doctor runs with other mounts.
#[test]
#[ignore = "needs root"]
fn as_root_doctor_reports_too_little_shared_memory() {
    let sandbox = Sandbox::new();
    let mounts = "mount -t tmpfs -o size=16m tmpfs /dev/shm";
    let (findings, code) = examined(&mut with_mounts(&sandbox.command("tabula"), mounts));
    let (verdict, sentence) = of_check(&findings, "shared memory");
    assert_eq!((verdict, code), ("failure", 1), "{sentence}");
    assert!(sentence.contains("remount,size="), "{sentence}");
}
