//! Tasks of the robot: the table is cleared, objects are fetched, and what interrupts a task.

use crate::command_line::{JsonType, check_shape};
use crate::daemon::{Daemon, Sandbox, eventually};
use crate::simulation::scene_file;
use JsonType::{Count, List, Text, TextOrNull, Truth};
use message::ProcessKind;
use rustix::process::Signal;
use serde_json::Value;
use std::time::{Duration, Instant};

/// Longest time of a task, on a machine that does other things.
const WATCHDOG: Duration = Duration::from_secs(240);
/// Number of tasks after which one must have reached its phase: a grasp may fail, as in the world.
const N_TASKS: usize = 4;
/// Phases with an object in the hand.
const IN_HAND: [&str; 3] = ["lift", "check_lift", "carry"];
/// Exit code of a refusal, and of a task without its goal.
const REFUSED: i32 = 4;

/// Two objects within the arm's reach.
const TWO_OBJECTS: &str = "
seed = 3
[arm]
[[object]]
category = 'soda-can'
position_m = [-0.10, 0.0]
[[object]]
category = 'milk-carton'
position_m = [0.08, 0.05]
";

/// Can within the arm's reach.
const CAN: &str = "
seed = 3
[arm]
[[object]]
category = 'soda-can'
position_m = [-0.10, 0.0]
";

/// Places beside each other at the near rim, within the arm's reach.
const PLACES: &str = "
[places.side]
outline = [[-0.34, -0.34], [-0.14, -0.34], [-0.14, -0.14], [-0.34, -0.14]]
categories = ['can']
[places.hand-over]
outline = [[0.08, -0.34], [0.30, -0.34], [0.30, -0.12], [0.08, -0.12]]
categories = ['carton']
";

const TASK: &[(&str, JsonType)] = &[
    ("task_id", JsonType::CountOrNull),
    ("kind", Text),
    ("author", Text),
    ("phase", Text),
    ("is_paused", Truth),
    ("waits_for", Text),
    ("track_id", JsonType::CountOrNull),
    ("label", TextOrNull),
    ("place", TextOrNull),
    ("attempt", Count),
    ("n_done", Count),
    ("sentence", Text),
    ("planned", List),
    ("left", List),
];

const PLANNED: &[(&str, JsonType)] = &[("track_id", Count), ("label", TextOrNull), ("place", Text)];

const LEFT: &[(&str, JsonType)] = &[("track_id", Count), ("reason", Text)];

/// State of the running or last task.
fn state(daemon: &Daemon<'_>, verb: &[&str]) -> Value {
    let report = daemon.ask(&[&["task"], verb].concat());
    check_shape(&report, TASK);
    for (key, shape) in [("planned", PLANNED), ("left", LEFT)] {
        let rows = report[key].as_array().unwrap();
        for row in rows {
            check_shape(row, shape);
        }
    }
    report
}

/// Waits until a task is in one of some phases, as its record in the memory or its report tells.
fn wait_for_phase(sandbox: &Sandbox, phases: &[&str]) -> Value {
    let begun = Instant::now();
    loop {
        let output = sandbox.tabula(&["task", "state", "--json"]);
        if let Ok(report) = serde_json::from_slice::<Value>(&output.stdout)
            && phases.contains(&report["phase"].as_str().unwrap_or_default())
        {
            println!("{report}");
            return report;
        }
        assert!(begun.elapsed() < WATCHDOG, "no phase of {phases:?}");
        std::thread::sleep(Duration::from_millis(30));
    }
}

/// Starts a task until one reaches some phases; after one that has failed the hand opens, and the arm
/// moves out of the camera's sight. Returns the report in that phase.
fn reach_phase(sandbox: &Sandbox, daemon: &Daemon<'_>, order: &[&str], phases: &[&str]) -> Value {
    for _ in 0..N_TASKS {
        let tracks = from_left(daemon.wait_for("an object is seen", |objects| !objects.is_empty()));
        let order: Vec<&str> = order
            .iter()
            .map(|word| if *word == "OBJECT" { &*tracks[0] } else { word })
            .collect();
        state(daemon, &[&["start"], &order[..]].concat());
        let report = wait_for_phase(sandbox, &[phases, &["failed"]].concat());
        if report["phase"] != "failed" {
            return report;
        }
        recover(sandbox);
    }
    panic!("no task of {order:?} reaches {phases:?}\n{}", daemon.log());
}

/// Opens the hand, and moves the arm out of the camera's sight.
fn recover(sandbox: &Sandbox) {
    for verb in ["open", "home"] {
        let output = sandbox.tabula(&["arm", verb]);
        println!("{}", String::from_utf8_lossy(&output.stdout));
    }
}

/// Place of an object near a category's place, metres.
fn stands_in(daemon: &Daemon<'_>, low_m: [f64; 2], high_m: [f64; 2]) -> bool {
    daemon.objects().iter().any(|object| {
        let at = |axis: usize| object["position_m"][axis].as_f64().unwrap();
        object["state"] == "tracked"
            && (0..2).all(|axis| (low_m[axis]..=high_m[axis]).contains(&at(axis)))
    })
}

fn is_at_side(daemon: &Daemon<'_>) -> bool {
    stands_in(daemon, [-0.34, -0.34], [-0.14, -0.14])
}

fn is_at_hand_over(daemon: &Daemon<'_>) -> bool {
    stands_in(daemon, [0.08, -0.34], [0.30, -0.12])
}

/// Starts a daemon with places, and waits for its objects.
fn start<'a>(
    sandbox: &'a Sandbox,
    scene: &str,
    n_objects: usize,
) -> (tempfile::TempDir, Daemon<'a>, Vec<Value>) {
    sandbox.configure(PLACES);
    let (scene, source) = scene_file(scene);
    let daemon = sandbox.start(&["--source", &source]);
    let objects = daemon.wait_for("all objects are tracked", |objects| {
        objects.len() == n_objects
    });
    (scene, daemon, objects)
}

/// The object farther to the left first.
fn from_left(mut objects: Vec<Value>) -> Vec<String> {
    let x = |object: &Value| object["position_m"][0].as_f64().unwrap();
    objects.sort_by(|a, b| x(a).total_cmp(&x(b)));
    let tracks = objects.iter().map(|object| object["track_id"].to_string());
    tracks.collect()
}

#[test]
fn table_is_cleared_and_a_person_is_asked_for_a_name() {
    let sandbox = Sandbox::new();
    let (_scene, daemon, objects) = start(&sandbox, TWO_OBJECTS, 2);
    let tracks = from_left(objects);
    daemon.ask(&["teach", &tracks[0], "can"]);
    eventually("the can is known", || {
        daemon
            .objects()
            .iter()
            .any(|object| object["label"] == "can")
    });
    let preview = state(&daemon, &["preview", "clear-table"]);
    assert_eq!(preview["planned"][0]["place"], "side", "{preview:#}");
    let begun = state(&daemon, &["start", "clear-table"]);
    assert_eq!(begun["task_id"], 1);
    let (code, sentence) = daemon.refused(&["task", "start", "clear-table"]);
    assert_eq!(code, REFUSED);
    assert!(sentence.contains("task 1 runs"), "{sentence}");
    // The can is named, then the carton needs a name.
    let asking = wait_for_phase(&sandbox, &["ask"]);
    let asked = asking["left"].as_array().unwrap().iter();
    let mut asked = asked.filter(|left| left["reason"].as_str().unwrap().contains("needs a name"));
    let carton = asked.next().unwrap()["track_id"].to_string();
    daemon.ask(&["teach", &carton, "carton"]);
    let mut end = wait_for_phase(&sandbox, &["succeeded", "failed"]);
    if end["phase"] == "failed" {
        recover(&sandbox);
        end = reach_phase(&sandbox, &daemon, &["clear-table"], &["succeeded"]);
    }
    assert!(is_at_side(&daemon) && is_at_hand_over(&daemon), "{end:#}");
    let record = daemon.ask(&["task", "show", &end["task_id"].to_string()]);
    assert_eq!(record["state"], "succeeded");
    let mut steps = record["steps"].as_array().unwrap().iter();
    let carried = steps.find(|step| step["state"] == "succeeded").unwrap();
    assert!(carried["plan"].as_str().unwrap().contains("to_place_rad"));
    daemon.stop();
}

/// Repeats a trial until it ends well; the arm recovers after each one that does not.
fn repeat((sandbox, daemon): (&Sandbox, &Daemon<'_>), trial: impl Fn() -> Value, end: &str) {
    for _ in 0..N_TASKS {
        let report = trial();
        if report["phase"] == end {
            return;
        }
        recover(sandbox);
    }
    panic!("no task ends as {end}\n{}", daemon.log());
}

#[test]
fn killed_executive_goes_on_and_a_stop_waits_for_a_person() {
    let sandbox = Sandbox::new();
    let (_scene, daemon, _) = start(&sandbox, CAN, 1);
    let killed = || {
        reach_phase(&sandbox, &daemon, &["fetch", "OBJECT"], &IN_HAND);
        daemon.signal(ProcessKind::EXECUTIVE, Signal::KILL);
        wait_for_phase(&sandbox, &["succeeded", "failed"])
    };
    repeat((&sandbox, &daemon), killed, "succeeded");
    assert!(daemon.log().contains("goes on from its record"));
    assert!(is_at_hand_over(&daemon));
    // The same object to another place, with a stop on the way.
    let stopped = || {
        let order = ["fetch", "OBJECT", "--to", "side"];
        reach_phase(&sandbox, &daemon, &order, &IN_HAND);
        daemon.ask(&["arm", "stop"]);
        let halted = wait_for_phase(&sandbox, &["halt"]);
        let waits_for = halted["waits_for"].as_str().unwrap();
        assert!(waits_for.contains("task resume"), "{halted:#}");
        std::thread::sleep(Duration::from_millis(500));
        assert_eq!(state(&daemon, &["state"])["phase"], "halt");
        state(&daemon, &["resume"]);
        wait_for_phase(&sandbox, &["succeeded", "failed"])
    };
    repeat((&sandbox, &daemon), stopped, "succeeded");
    assert!(is_at_side(&daemon));
    daemon.stop();
}

#[test]
fn paused_task_waits_and_a_cancelled_one_sets_its_object_down() {
    let sandbox = Sandbox::new();
    let (_scene, daemon, _) = start(&sandbox, CAN, 1);
    let cancelled = || {
        let fetch = ["fetch", "OBJECT"];
        reach_phase(&sandbox, &daemon, &fetch, &["reach"]);
        assert_eq!(state(&daemon, &["pause"])["is_paused"], true);
        let joints = || {
            std::thread::sleep(Duration::from_millis(1500));
            daemon.ask(&["arm", "state"])["joint_angles_rad"].clone()
        };
        assert_eq!(joints(), joints(), "a paused arm rests");
        assert_eq!(state(&daemon, &["resume"])["is_paused"], false);
        let report = wait_for_phase(&sandbox, &[&IN_HAND[..], &["failed"]].concat());
        if report["phase"] == "failed" {
            return report;
        }
        state(&daemon, &["cancel"]);
        wait_for_phase(&sandbox, &["cancelled", "failed"])
    };
    repeat((&sandbox, &daemon), cancelled, "cancelled");
    assert_eq!(daemon.ask(&["arm", "state"])["is_holding"], false);
    daemon.wait_for("the can stands on the table", |objects| objects.len() == 1);
    let (code, sentence) = daemon.refused(&["task", "resume", "1"]);
    assert_eq!(code, REFUSED);
    assert!(sentence.contains("does not run"), "{sentence}");
    daemon.stop();
}

#[test]
fn order_that_cannot_be_carried_out_is_a_sentence() {
    let sandbox = Sandbox::new();
    let (_scene, daemon, _) = start(&sandbox, CAN, 1);
    // The gateway closes a connection that was silent for 10 s.
    std::thread::sleep(Duration::from_secs(11));
    let refused = |words: &[&str], part: &str| {
        let (code, sentence) = daemon.refused(&[&["task"], words].concat());
        assert_eq!(code, REFUSED, "{sentence}");
        assert!(sentence.contains(part), "{sentence}");
    };
    refused(
        &["start", "fetch", "1", "--to", "attic"],
        "no place \"attic\"",
    );
    refused(&["cancel"], "no task has run");
    refused(&["pause", "3"], "task 3 does not run");
    let absent = |object: &[&str], part: &str| {
        let words = [&["task", "start", "fetch", "--wait", "--json"], object].concat();
        let absent = sandbox.tabula(&words);
        assert_eq!(absent.status.code(), Some(REFUSED));
        let lines = String::from_utf8(absent.stdout).unwrap();
        let last: Value = serde_json::from_str(lines.lines().last().unwrap()).unwrap();
        assert!(
            last["sentence"].as_str().unwrap().contains(part),
            "{last:#}"
        );
    };
    absent(&["77"], "Object 77 is not seen");
    absent(&["--category", "spoon"], "No spoon is seen");
    let graph = daemon.ask(&["task", "graph", "clear-table"]);
    assert!(
        graph["mermaid"]
            .as_str()
            .unwrap()
            .contains("carry --> lower: done")
    );
    assert_eq!(
        daemon.ask(&["task", "list"])["tasks"]
            .as_array()
            .unwrap()
            .len(),
        2
    );
    daemon.stop();
}
