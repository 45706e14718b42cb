//! Object models that grow beside a running daemon, while its camera moves around the table.

use crate::daemon::{Daemon, Sandbox, eventually, send_signal, wait_for_end};
use rustix::process::Signal;
use serde_json::Value;
use std::process::{Child, Stdio};
use std::time::Duration;

/// Scene of two objects, with a camera that leads around it in 12 s.
const ORBIT: &str = "
seed = 5
[camera]
distance_m = 0.9
elevation_deg = 40.0
orbit_deg_s = 30.0
[[object]]
category = 'milk-carton'
position_m = [0.0, 0.0]
yaw_deg = 30.0
[[object]]
category = 'mug'
position_m = [0.3, 0.1]
";

/// Frame rate of the simulation.
const FRAMES_PER_SECOND: u64 = 30;

/// Exit codes of a failure in general, of a daemon that does not run, and of a refusal.
const GENERAL: i32 = 1;
const NO_DAEMON: i32 = 3;
const REFUSED: i32 = 4;

/// Start of a builder, whose answer is JSON. It is not niced, because other tests take all cores.
fn build(sandbox: &Sandbox, options: &[&str]) -> Child {
    let mut command = sandbox.command("tabula");
    let common = ["model", "build", "--json", "--niceness", "0"];
    command.args(common).args(options);
    command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Answer of a builder that has succeeded.
fn answer(child: Child) -> Value {
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Scene of a box and an apple before a camera that stands still.
const STILL: &str = "
seed = 5
[camera]
distance_m = 0.9
elevation_deg = 40.0
[[object]]
category = 'cereal-box'
position_m = [0.0, 0.0]
yaw_deg = 20.0
[[object]]
category = 'apple'
position_m = [0.3, 0.1]
";

/// Person who turns the box by 30°, twice.
const TURNING_PERSON: &str = "
[person]
pace = 2.0
[[person.action]]
at_s = 6.0
do = 'turn'
object = 1
by_deg = 30.0
[[person.action]]
at_s = 15.0
do = 'turn'
object = 1
by_deg = 30.0
";

fn started<'a>(sandbox: &'a Sandbox, scene: &str) -> Daemon<'a> {
    let file = sandbox.home().join("scene.toml");
    std::fs::write(&file, scene).unwrap();
    let source = format!("simulation:{}", file.display());
    let daemon = sandbox.start(&["--source", &source]);
    daemon.wait_for("both objects are tracked", |objects| objects.len() >= 2);
    daemon
}

/// Track-id of the tallest object: the carton, or the box.
fn tallest(daemon: &Daemon<'_>) -> u64 {
    let objects = daemon.objects();
    let height = |object: &Value| object["size_m"][2].as_f64().unwrap();
    let tallest = objects
        .iter()
        .max_by(|a, b| height(a).total_cmp(&height(b)));
    tallest.unwrap()["track_id"].as_u64().unwrap()
}

#[test]
fn model_grows_while_the_camera_moves_and_is_stored_and_exported() {
    let sandbox = Sandbox::new();
    let daemon = started(&sandbox, ORBIT);
    let track = tallest(&daemon).to_string();
    let options = [
        &track,
        "--name",
        "carton",
        "--step-deg",
        "12",
        "--until-closed",
        "--seconds",
        "120",
    ];
    let built = answer(build(&sandbox, &options));
    assert_eq!(built["name"], "carton");
    assert_eq!(built["is_closed_loop"], true, "{built}");
    assert!(built["views"].as_u64().unwrap() >= 12, "{built}");
    assert!(built["completeness"].as_f64().unwrap() > 0.3, "{built}");
    // A generated carton is a box of about 7 x 7 x 20 cm, and stands at 30° to the axes.
    let side = |axis: usize| built["extents_mm"][axis].as_f64().unwrap();
    assert!((140.0..280.0).contains(&side(2)), "{built}");
    assert!(
        (60.0..160.0).contains(&side(0)) && (60.0..160.0).contains(&side(1)),
        "{built}"
    );
    let shown = daemon.ask(&["model", "show", "carton"]);
    let n_shown = shown["views"].as_array().unwrap().len() as u64;
    assert_eq!(Some(n_shown), built["views"].as_u64());
    let file = sandbox.home().join("carton.ply");
    daemon.ask(&["model", "export", "carton", "--out", file.to_str().unwrap()]);
    let mesh = dataset::ply::open(&file).unwrap();
    assert_eq!(
        mesh.triangles.len() as u64,
        built["triangles"].as_u64().unwrap()
    );
    daemon.stop();
}

#[test]
fn stopped_builder_stores_what_it_has_and_a_killed_one_leaves_what_has_grown() {
    let sandbox = Sandbox::new();
    let daemon = started(&sandbox, ORBIT);
    let track = tallest(&daemon).to_string();
    let mut killed = build(&sandbox, &[&track, "--name", "killed"]);
    let has_grown = || {
        let listed = daemon.ask(&["model", "list"]);
        let mut models = listed["models"].as_array().unwrap().iter();
        models.any(|model| model["name"] == "killed (unfinished)")
    };
    eventually("the model is kept while it grows", has_grown);
    send_signal(killed.id(), Signal::KILL).unwrap();
    assert!(wait_for_end(&mut killed, Duration::from_secs(5)).is_some());
    let kept = daemon.ask(&["model", "show", "killed (unfinished)"]);
    assert!(kept["views"].as_array().unwrap().len() >= 4, "{kept}");
    let part = |name: &str, signal: Signal| {
        let options = [&track, "--name", name, "--step-deg", "12"];
        let stopped = build(&sandbox, &options);
        std::thread::sleep(Duration::from_secs(5));
        send_signal(stopped.id(), signal).unwrap();
        answer(stopped)
    };
    let terminated = part("terminated", Signal::TERM);
    assert_eq!(terminated["end"], "stopped");
    assert!(terminated["left_out"].is_number(), "{terminated}");
    if terminated["views"].as_u64().unwrap() > 1 {
        assert_eq!(terminated["is_agreed"], false, "{terminated}");
    }
    // The views that wait at Ctrl-C are added.
    let part = part("part", Signal::INT);
    assert_eq!(
        (&part["end"], &part["left_out"]),
        (&"stopped".into(), &0.into())
    );
    assert_eq!(part["is_agreed"], true);
    assert!(part["next_move"]["right_deg"].is_number(), "{part}");
    assert!(part["views"].as_u64().unwrap() >= 1, "{part}");
    assert!(!part["missing"].as_array().unwrap().is_empty(), "{part}");
    let listed = daemon.ask(&["model", "list"]);
    let names = listed["models"].as_array().unwrap().iter();
    let names: Vec<&Value> = names.map(|model| &model["name"]).collect();
    assert_eq!(names, ["killed (unfinished)", "part", "terminated"]);
    eventually("perception goes on", || daemon.objects().len() >= 2);
    daemon.stop();
}

#[test]
fn object_that_a_person_turns_is_seen_from_its_other_sides() {
    let sandbox = Sandbox::new();
    let daemon = started(&sandbox, &format!("{STILL}{TURNING_PERSON}"));
    let track = tallest(&daemon).to_string();
    let building = build(&sandbox, &[&track, "--name", "box", "--step-deg", "12"]);
    eventually("both turns have ended", || {
        let frame = daemon.ask(&["objects"])["frame_sequence"].as_u64();
        frame.unwrap() > 28 * FRAMES_PER_SECOND
    });
    send_signal(building.id(), Signal::INT).unwrap();
    let built = answer(building);
    let shown = daemon.ask(&["model", "show", "box"]);
    let turns_deg = turns_deg(&shown);
    for turn_deg in [30.0, 60.0] {
        let is_seen = |found: &f64| (found.abs() - turn_deg).abs() < 8.0;
        assert!(turns_deg.iter().any(is_seen), "{turns_deg:?} {built}");
    }
    daemon.stop();
}

/// Turns of the cameras of a model's views about the vertical, from that of the first one, degrees.
fn turns_deg(shown: &Value) -> Vec<f64> {
    let azimuth_deg = |view: &Value| {
        let [x, y] = [0, 1].map(|axis| view["position_m"][axis].as_f64().unwrap());
        y.atan2(x).to_degrees()
    };
    let views = shown["views"].as_array().unwrap();
    let first_deg = azimuth_deg(&views[0]);
    let turn = |view: &Value| (azimuth_deg(view) - first_deg + 540.0).rem_euclid(360.0) - 180.0;
    views.iter().map(turn).collect()
}

#[test]
fn name_that_the_object_contradicts_is_refused_and_a_still_camera_has_the_object_turned() {
    let sandbox = Sandbox::new();
    let daemon = started(&sandbox, STILL);
    let track = tallest(&daemon).to_string();
    daemon.ask(&["teach", &track, "cereal box"]);
    let refused = |options: &[&str], part: &str| {
        let output = build(&sandbox, options).wait_with_output().unwrap();
        let sentence = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(REFUSED), "{sentence}");
        assert!(sentence.contains(part), "{sentence}");
        assert!(sentence.contains("--anyway"), "{sentence}");
    };
    refused(
        &["cereal box", "--name", "teapot"],
        "is recognised as cereal box",
    );
    assert_eq!(
        daemon.ask(&["model", "list"])["models"],
        serde_json::json!([])
    );
    let options = [
        "cereal box",
        "--name",
        "teapot",
        "--anyway",
        "--seconds",
        "4",
    ];
    let built = build(&sandbox, &options).wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&built.stderr).into_owned();
    let next = told.lines().filter_map(|line| line.split_once("next: "));
    let next: Vec<&str> = next.map(|(_, next)| next).collect();
    assert!(!next.is_empty(), "{told}");
    for next in next {
        assert!(next.starts_with("turn the object "), "{told}");
    }
    let built: Value = serde_json::from_slice(&built.stdout).unwrap();
    assert_eq!(built["next_move"]["by"], "object", "{built}");
    assert!(
        built["next_move"]["up_deg"].as_f64().unwrap().abs() < 0.1,
        "{built}"
    );

    // The apple is much smaller than what is stored as a teapot now.
    let objects = daemon.objects();
    let box_id = track.parse().ok();
    let apple = objects.iter().find(|o| o["track_id"].as_u64() != box_id);
    let apple = apple.unwrap()["track_id"].to_string();
    refused(
        &[&apple, "--name", "teapot"],
        "the stored model \"teapot\" is",
    );
    daemon.stop();
}

#[test]
fn builder_without_a_daemon_or_an_object_says_so() {
    let sandbox = Sandbox::new();
    let refused = |options: &[&str]| {
        let output = build(&sandbox, options).wait_with_output().unwrap();
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    let (code, sentence) = refused(&[]);
    assert_eq!(code, Some(NO_DAEMON), "{sentence}");
    let daemon = started(&sandbox, ORBIT);
    let (code, sentence) = refused(&["4711"]);
    assert_eq!(code, Some(GENERAL), "{sentence}");
    assert!(
        sentence.contains("there is no object 4711; there are "),
        "{sentence}"
    );
    daemon.stop();
}
