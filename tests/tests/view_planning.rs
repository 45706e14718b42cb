//! Next best view beside a running daemon: plans, their topic, and plans that follow each other.

use crate::command_line::{JsonType, check_list, check_shape};
use crate::daemon::{Daemon, Sandbox, send_signal, wait_for_end};
use crate::documents::store_model;
use crate::recorder::Recorder;
use JsonType::{Count, CountOrNull, Document, List, Number, NumberOrNull, Text, TextOrNull};
use JsonType::{Truth, Vector};
use channel::topic::ViewPlans;
use rustix::process::Signal;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::Stdio;
use std::time::Duration;

/// Scene of a carton that hides a mug, with two more objects, seen from the near side.
const ROW: &str = "
seed = 5
[camera]
distance_m = 0.9
elevation_deg = 25.0
[[object]]
category = 'milk-carton'
position_m = [0.0, -0.05]
yaw_deg = 30.0
[[object]]
category = 'mug'
position_m = [0.05, 0.14]
[[object]]
category = 'bowl'
position_m = [-0.28, 0.05]
[[object]]
category = 'bottle'
position_m = [0.3, 0.1]
";

/// Camera that leads around two objects in 12 s.
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

const PLAN: &[(&str, JsonType)] = &[
    ("chosen", Document(VIEW)),
    ("reason", Text),
    ("motion", Text),
    ("present", Document(PRESENT)),
    ("views", List),
    ("hypotheses", List),
    ("objects", List),
    ("n_background_points", Count),
    ("n_unknown_voxels", Count),
    ("n_visited", Count),
    ("frame_sequence", Count),
    ("source_name", Text),
    ("has_world_pose", Truth),
    ("is_published", Truth),
    ("notes", List),
    ("processing_ms", Number),
];
const VIEW: &[(&str, JsonType)] = &[
    ("index", Count),
    ("rank", CountOrNull),
    ("state", Text),
    ("position_m", Vector(3)),
    ("orientation_xyzw", Vector(4)),
    ("direction", Vector(3)),
    ("down_deg", Number),
    ("entropy", Number),
    ("gain", Number),
    ("weight", Number),
    ("utility", Number),
    ("n_objects_seen", Count),
    ("distance_m", Number),
    ("angle_deg", Number),
];
const PRESENT: &[(&str, JsonType)] = &[
    ("index", CountOrNull),
    ("rank", CountOrNull),
    ("state", Text),
    ("position_m", Vector(3)),
    ("orientation_xyzw", Vector(4)),
    ("direction", Vector(3)),
    ("down_deg", Number),
    ("entropy", Number),
    ("gain", Number),
    ("weight", Number),
    ("utility", Number),
    ("n_objects_seen", Count),
    ("distance_m", Number),
    ("angle_deg", Number),
];
const HYPOTHESIS: &[(&str, JsonType)] = &[
    ("track_id", Count),
    ("label", TextOrNull),
    ("source", Text),
    ("answer", Text),
    ("contradiction", NumberOrNull),
    ("position_m", Vector(3)),
    ("orientation_xyzw", Vector(4)),
    ("n_points", Count),
    ("visible_now", Number),
    ("visible_then", Number),
    ("note", Text),
];
const SCENE_OBJECT: &[(&str, JsonType)] = &[
    ("track_id", Count),
    ("label", TextOrNull),
    ("answer", Text),
    ("state", Text),
    ("is_planned_for", Truth),
];

/// Exit codes of a failure in general, of wrong usage, and of a daemon that does not run.
const GENERAL: i32 = 1;
const USAGE: i32 = 2;
const NO_DAEMON: i32 = 3;

fn started<'a>(sandbox: &'a Sandbox, scene: &str, n_objects: usize) -> Daemon<'a> {
    let file = sandbox.home().join("scene.toml");
    std::fs::write(&file, scene).unwrap();
    let source = format!("simulation:{}", file.display());
    let daemon = sandbox.start(&["--source", &source, "--rate", "10"]);
    daemon.wait_for("the objects are tracked", |objects| {
        let tracked = objects.iter().filter(|o| o["state"] == "tracked");
        tracked.count() >= n_objects
    });
    daemon
}

/// Poses of views in a file for `--views` and `--visited`.
fn pose_file(sandbox: &Sandbox, name: &str, views: &[&Value]) -> PathBuf {
    let pose = |view: &&Value| {
        let (position, orientation) = (&view["position_m"], &view["orientation_xyzw"]);
        json!({"position_m": position, "orientation_xyzw": orientation})
    };
    let poses: Vec<Value> = views.iter().map(pose).collect();
    let file = sandbox.home().join(name);
    std::fs::write(&file, json!(poses).to_string()).unwrap();
    file
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|number| number.as_f64().unwrap()).collect()
}

fn distance_m(a: &Value, b: &Value) -> f64 {
    let pairs = numbers(&a["position_m"])
        .into_iter()
        .zip(numbers(&b["position_m"]));
    pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn view_plan_chooses_a_new_view_of_more_entropy_and_publishes_it() {
    let sandbox = Sandbox::new();
    let plans = Recorder::<ViewPlans>::start(&sandbox);
    let daemon = started(&sandbox, ROW, 3);
    let picture = sandbox.home().join("plan.png");
    let options = ["view", "plan", "--picture", picture.to_str().unwrap()];
    let plan = daemon.ask(&options);
    check_shape(&plan, PLAN);
    check_list(&plan["views"], VIEW);
    check_list(&plan["hypotheses"], HYPOTHESIS);
    check_list(&plan["objects"], SCENE_OBJECT);
    let views = plan["views"].as_array().unwrap();
    let chosen = &plan["chosen"];
    assert_eq!((views.len(), &chosen["rank"]), (100, &json!(1)));
    assert_eq!(&views[chosen["index"].as_u64().unwrap() as usize], chosen);
    assert!(distance_m(chosen, &plan["present"]) > 0.01, "{chosen}");
    let mut entropies: Vec<f64> = views
        .iter()
        .map(|v| v["entropy"].as_f64().unwrap())
        .collect();
    entropies.sort_by(f64::total_cmp);
    assert!(
        chosen["entropy"].as_f64().unwrap() >= entropies[50],
        "{chosen}"
    );
    let n_hypotheses = plan["hypotheses"].as_array().unwrap().len() as u64;
    assert!(n_hypotheses >= 3, "{plan}");
    let n_seen = chosen["n_objects_seen"].as_u64().unwrap();
    assert!(n_seen >= 3 && n_seen >= plan["present"]["n_objects_seen"].as_u64().unwrap());
    assert!(
        plan["n_unknown_voxels"].as_u64().unwrap() > 1000,
        "{}",
        plan["n_unknown_voxels"]
    );
    let png = std::fs::read(&picture).unwrap();
    assert!(
        png.starts_with(b"\x89PNG") && png.len() > 2000,
        "{}",
        png.len()
    );

    plans.wait_for("the plan is received", |plans| !plans.is_empty());
    let sent = plans.last().unwrap();
    let frame = (&plan["frame_sequence"], &plan["is_published"]);
    assert_eq!((&json!(sent.header.sequence), &json!(true)), frame);
    assert_eq!((sent.header.n_candidates, sent.items.len()), (100, 100));
    assert_eq!((sent.items[0].is_chosen, sent.items[0].rank), (1, 1));
    assert!(sent.items.iter().all(|view| view.checked().is_some()));
    let position = sent.items[0].world_from_camera.position_m;
    assert_eq!(json!(position), chosen["position_m"]);

    // A visited view is not chosen again.
    let visited = pose_file(&sandbox, "visited.json", &[chosen]);
    let again = daemon.ask(&["view", "plan", "--visited", visited.to_str().unwrap()]);
    assert!(
        distance_m(&again["chosen"], chosen) > 0.01,
        "{}",
        again["chosen"]
    );
    assert_eq!(again["n_visited"], 2);
    plans.stop();
    daemon.stop();
}

#[test]
fn view_plan_takes_reachable_views_and_refuses_bad_ones_with_a_sentence() {
    let sandbox = Sandbox::new();
    let (code, sentence) = refused(&sandbox, &[]);
    assert_eq!(code, Some(NO_DAEMON), "{sentence}");
    let empty = pose_file(&sandbox, "empty.json", &[]);
    let (code, sentence) = refused(&sandbox, &["--views", empty.to_str().unwrap()]);
    assert_eq!(code, Some(USAGE), "{sentence}");
    assert!(
        sentence.contains("has none; give at least one view"),
        "{sentence}"
    );
    let (code, sentence) = refused(&sandbox, &["--candidates", "0"]);
    assert_eq!(code, Some(USAGE), "{sentence}");

    let daemon = started(&sandbox, ROW, 3);
    let plan = daemon.ask(&["view", "plan", "--candidates", "12", "--gain-weight", "0"]);
    let views: Vec<&Value> = plan["views"].as_array().unwrap().iter().collect();
    assert_eq!((views.len(), &plan["n_unknown_voxels"]), (12, &json!(0)));
    let reachable = pose_file(&sandbox, "reachable.json", &views[3..6]);
    let plan = daemon.ask(&[
        "view",
        "plan",
        "--views",
        reachable.to_str().unwrap(),
        "--sampled",
    ]);
    let positions: Vec<&Value> = views[3..6].iter().map(|view| &view["position_m"]).collect();
    let chosen = numbers(&plan["chosen"]["position_m"]);
    let is_chosen = |position: &&&Value| {
        numbers(position)
            .iter()
            .zip(&chosen)
            .all(|(a, b)| (a - b).abs() < 1e-6)
    };
    assert!(
        positions.iter().any(|position| is_chosen(&position)),
        "{chosen:?}"
    );
    let present = pose_file(&sandbox, "present.json", &[&plan["present"]]);
    let (code, sentence) = refused(&sandbox, &["--views", present.to_str().unwrap()]);
    assert_eq!(code, Some(GENERAL), "{sentence}");
    assert!(
        sentence.contains("none of the 1 candidate views is left: 1 were visited"),
        "{sentence}"
    );
    std::fs::write(&present, r#"[{"position_m": [0, 0, "high"]}]"#).unwrap();
    let (code, sentence) = refused(&sandbox, &["--visited", present.to_str().unwrap()]);
    assert_eq!(code, Some(USAGE), "{sentence}");
    assert!(sentence.contains("bad entry 0"), "{sentence}");
    daemon.stop();
}

/// Exit code and sentence of a plan that must fail.
fn refused(sandbox: &Sandbox, options: &[&str]) -> (Option<i32>, String) {
    let output = sandbox.tabula(&[&["view", "plan"], options].concat());
    let sentence = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.code(), sentence)
}

#[test]
fn view_plan_watch_plans_anew_when_the_objects_change_and_ends_on_sigterm() {
    let sandbox = Sandbox::new();
    let daemon = started(&sandbox, ROW, 3);
    let mut command = sandbox.command("tabula");
    command.args(["view", "plan", "--watch", "--json"]);
    command.stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut next = || -> Value { serde_json::from_str(&lines.next().unwrap().unwrap()).unwrap() };
    let first = next();
    check_shape(&first, PLAN);
    assert_eq!(first["n_visited"], 1);
    let track = &first["hypotheses"][0]["track_id"];
    // The stored model is a sheet that does not fit any object, and is told not to be used.
    store_model(&sandbox, "thing");
    daemon.ask(&["teach", &track.to_string(), "thing"]);
    let is_taught = |plan: &Value| {
        let hypotheses = plan["hypotheses"].as_array().unwrap().iter();
        hypotheses.filter(|h| h["label"] == "thing").count() > 0
    };
    let mut plan = next();
    while !is_taught(&plan) {
        plan = next();
    }
    assert!(plan["n_visited"].as_u64().unwrap() >= 2, "{plan}");
    let hypotheses = plan["hypotheses"].as_array().unwrap().iter();
    let taught = hypotheses.filter(|h| h["label"] == "thing");
    for hypothesis in taught {
        assert_eq!(hypothesis["source"], "measured", "{hypothesis}");
        let note = hypothesis["note"].as_str().unwrap();
        assert!(note.contains("stored model"), "{hypothesis}");
    }
    send_signal(child.id(), Signal::TERM).unwrap();
    let status = wait_for_end(&mut child, Duration::from_secs(10)).unwrap();
    assert!(status.success(), "{status:?}");
    daemon.stop();
}

#[test]
fn view_plan_places_the_stored_model_of_a_labelled_object() {
    let sandbox = Sandbox::new();
    let daemon = started(&sandbox, ORBIT, 2);
    let height = |object: &Value| object["size_m"][2].as_f64().unwrap();
    let objects = daemon.objects();
    let tallest = objects
        .iter()
        .max_by(|a, b| height(a).total_cmp(&height(b)));
    let id = tallest.unwrap()["track_id"].clone();
    let track = id.to_string();
    let build = [
        "model",
        "build",
        &track,
        "--name",
        "carton",
        "--until-closed",
    ];
    let built = daemon.ask(&[&build[..], &["--seconds", "60"]].concat());
    assert!(built["completeness"].as_f64().unwrap() > 0.3, "{built}");
    daemon.ask(&["teach", &track, "carton"]);
    daemon.wait_for("the carton has its label", |objects| {
        objects
            .iter()
            .any(|o| o["label"] == "carton" && o["track_id"] == id)
    });
    let plan = daemon.ask(&["view", "plan"]);
    let hypotheses = plan["hypotheses"].as_array().unwrap();
    let carton = hypotheses.iter().find(|h| h["track_id"] == id);
    let carton = carton.unwrap_or_else(|| panic!("{plan}"));
    assert_eq!(
        (&carton["source"], &carton["note"]),
        (&json!("model"), &json!("")),
        "{carton}"
    );
    assert!(carton["contradiction"].as_f64().unwrap() <= 0.6, "{carton}");
    let object = daemon.ask(&["ask", &track]);
    assert!(
        distance_m(carton, &object) < 0.15,
        "{carton} at {}",
        object["position_m"]
    );
    daemon.stop();
}
