//! `tabula grasp plan` and `tabula place plan`: what is planned is carried out by the simulated arm,
//! and what is not possible is a sentence.

use crate::arm_stop::Commander;
use crate::command_line::{JsonType, check_list, check_shape};
use crate::daemon::{Daemon, Sandbox};
use crate::simulation::scene_file;
use JsonType::{
    Count, Document, DocumentOrNull, List, Number, NumberOrNull, Text, TextOrNull, Truth, Vector,
};
use control_protocol::ArmMotion;
use serde_json::Value;
use std::path::Path;

/// Number of looks after which the object must have been lifted: an attempt may push it away.
const N_LOOKS: usize = 5;
/// Exit code of a refusal.
const REFUSED: i32 = 4;

const PLAN: &[(&str, JsonType)] = &[
    ("track_id", Count),
    ("label", TextOrNull),
    ("answer", Text),
    ("source", Text),
    ("sentence", TextOrNull),
    ("grasps", List),
    ("reasons", List),
    ("rejected", List),
    ("path", DocumentOrNull(PATH)),
    ("frame_sequence", Count),
    ("source_name", Text),
    ("has_world_pose", Truth),
    ("notes", List),
    ("processing_ms", Number),
];

const PATH: &[(&str, JsonType)] = &[
    ("kind", Text),
    ("waypoints_rad", List),
    ("seconds", Number),
    ("n_nodes", Count),
];

const PLACE_PLAN: &[(&str, JsonType)] = &[
    ("track_id", Count),
    ("label", TextOrNull),
    ("answer", Text),
    ("place", Text),
    ("sentence", TextOrNull),
    ("transport", DocumentOrNull(TRANSPORT)),
    ("frame_sequence", Count),
    ("source_name", Text),
    ("notes", List),
    ("processing_ms", Number),
];

const TRANSPORT: &[(&str, JsonType)] = &[
    ("to_grasp", Document(PATH)),
    ("grasp", Document(GRASP)),
    ("to_place", Document(PATH)),
    ("placement", Document(PLACEMENT)),
];

const PLACEMENT: &[(&str, JsonType)] = &[
    ("foot_m", Vector(3)),
    ("turn_deg", Number),
    ("surface", Text),
    ("position_m", Vector(3)),
    ("orientation_xyzw", Vector(4)),
    ("above_position_m", Vector(3)),
    ("retreat_position_m", Vector(3)),
    ("opening_mm", Number),
    ("above_rad", Vector(6)),
    ("release_rad", Vector(6)),
    ("retreat_rad", Vector(6)),
];

const PLACE_ROW: &[(&str, JsonType)] = &[
    ("name", Text),
    ("categories", List),
    ("outline_m", List),
    ("surface", TextOrNull),
    ("height_m", NumberOrNull),
    ("reached", NumberOrNull),
];

const GRASP: &[(&str, JsonType)] = &[
    ("score", Number),
    ("approach", Text),
    ("position_m", Vector(3)),
    ("orientation_xyzw", Vector(4)),
    ("approach_position_m", Vector(3)),
    ("lift_position_m", Vector(3)),
    ("opening_mm", Number),
    ("width_mm", Number),
    ("evidence", Text),
    ("factors", Document(FACTORS)),
    ("approach_rad", Vector(6)),
    ("grasp_rad", Vector(6)),
    ("lift_rad", Vector(6)),
];

const FACTORS: &[(&str, JsonType)] = &[
    ("balance", Number),
    ("centring", Number),
    ("contact", Number),
    ("evidence", Number),
    ("friction", Number),
    ("room", Number),
    ("seen_way", Number),
];

const REASON: &[(&str, JsonType)] = &[("reason", Text), ("n_grasps", Count)];

const REJECTED: &[(&str, JsonType)] = &[
    ("reason", Text),
    ("position_m", Vector(3)),
    ("orientation_xyzw", Vector(4)),
];

/// Carton out of the arm's reach.
const FAR: &str = "
seed = 3
[arm]
position_m = [-2.5, -0.5, 0.7]
[[object]]
category = 'milk-carton'
position_m = [-0.15, -0.05]
";

/// Can within the arm's reach.
const CAN: &str = "
seed = 3
[arm]
[[object]]
category = 'soda-can'
position_m = [-0.10, 0.0]
";

/// Ball, which has no thin part that a small hand could take.
const BALL: &str = "
seed = 3
[arm]
[[object]]
category = 'tennis-ball'
position_m = [-0.15, -0.05]
";

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    let list = value.as_array().unwrap();
    let numbers: Vec<f64> = list.iter().map(|number| number.as_f64().unwrap()).collect();
    numbers.try_into().unwrap()
}

/// Document of a plan for the one object of a scene; `None` where it is not seen at the moment.
fn planned(sandbox: &Sandbox, daemon: &Daemon<'_>, options: &[&str]) -> Option<Value> {
    let objects = daemon.wait_for("the object is tracked", |objects| !objects.is_empty());
    let track = objects[0]["track_id"].to_string();
    let [verb, options @ ..] = options else {
        panic!("a plan needs a verb");
    };
    let options = [&[verb, "plan", &track, "--json"], options].concat();
    let output = sandbox.tabula(&options);
    println!("{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).ok()
}

/// Grasps of the one object of a scene.
fn plan(sandbox: &Sandbox, daemon: &Daemon<'_>, picture: &Path) -> Option<Value> {
    let options = ["grasp", "--picture", picture.to_str().unwrap()];
    let plan = planned(sandbox, daemon, &options)?;
    check_shape(&plan, PLAN);
    check_list(&plan["grasps"], GRASP);
    check_list(&plan["reasons"], REASON);
    check_list(&plan["rejected"], REJECTED);
    Some(plan)
}

/// Motions along the path of a plan.
fn along(path: &Value) -> Vec<ArmMotion> {
    let waypoints = path["waypoints_rad"]
        .as_array()
        .into_iter()
        .flatten()
        .skip(1);
    let motion = |joints: &Value| ArmMotion::MoveJoints {
        angles_rad: numbers(joints),
    };
    waypoints.map(motion).collect()
}

/// Straight motion to a position of a grasp or of a placement.
fn straight_to(planned: &Value, position: &str) -> ArmMotion {
    ArmMotion::MoveTo {
        position_m: numbers(&planned[position]),
        orientation_xyzw: numbers(&planned["orientation_xyzw"]),
        straight: true,
    }
}

fn open_to(planned: &Value) -> ArmMotion {
    ArmMotion::OpenTo {
        opening_m: 1e-3 * planned["opening_mm"].as_f64().unwrap(),
    }
}

/// Motions of a grasp, from where the arm stands to the end of the lift.
fn lift(path: &Value, grasp: &Value) -> Vec<ArmMotion> {
    let mut motions = vec![open_to(grasp)];
    motions.extend(along(path));
    motions.push(straight_to(grasp, "position_m"));
    motions.push(ArmMotion::Close);
    motions.push(straight_to(grasp, "lift_position_m"));
    motions
}

/// Motions with a held object to its place, and away from it.
fn set_down(transport: &Value) -> Vec<ArmMotion> {
    let placement = &transport["placement"];
    let mut motions = along(&transport["to_place"]);
    motions.push(straight_to(placement, "position_m"));
    motions.push(open_to(placement));
    motions.push(straight_to(placement, "retreat_position_m"));
    motions.push(ArmMotion::Home);
    motions
}

/// Carries out motions until one does not end well; true if all do.
fn carry_out(commander: &Commander<'_>, motions: Vec<ArmMotion>) -> bool {
    motions.into_iter().all(|motion| {
        let report = commander.carry_out(&motion);
        println!("{}: {}", report.activity, report.note);
        report.activity == "idle"
    })
}

/// Sets a held object down; true if all motions end well. Else the hand opens, and the arm goes out of
/// the camera's sight.
fn is_set_down(commander: &Commander<'_>, transport: &Value) -> bool {
    let is_set_down = carry_out(commander, set_down(transport));
    if !is_set_down {
        give_up(commander);
    }
    is_set_down
}

/// Opens the hand, and moves the arm out of the camera's sight.
fn give_up(commander: &Commander<'_>) {
    commander.carry_out(&ArmMotion::Open);
    commander.carry_out(&ArmMotion::Home);
}

/// Carries out a grasp; true if the object is held after the lift. Else the arm gives up.
fn is_lifted(commander: &Commander<'_>, path: &Value, grasp: &Value) -> bool {
    let is_lifted = carry_out(commander, lift(path, grasp)) && commander.state().is_holding;
    if !is_lifted {
        give_up(commander);
    }
    is_lifted
}

#[test]
fn planned_grasp_lifts_the_object_after_few_looks() {
    let sandbox = Sandbox::new();
    let (_folder, source) = scene_file(CAN);
    let daemon = sandbox.start(&["--source", &source]);
    let picture = sandbox.home().join("grasp.png");
    let commander = Commander::new(&sandbox, 1, "anna");
    let is_lifted = (0..N_LOOKS).any(|_| {
        let plan = plan(&sandbox, &daemon, &picture).unwrap_or_default();
        let best = plan["grasps"].as_array().and_then(|grasps| grasps.first());
        let best = best.filter(|_| plan["path"].is_object());
        best.is_some_and(|grasp| is_lifted(&commander, &plan["path"], grasp))
    });
    assert!(is_lifted);
    assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    daemon.stop();
}

/// Places on the table of the simulation: one for cans, one that is out of reach, one for unknown
/// objects.
const PLACES: &str = "
[places.side]
outline = [[-0.28, -0.28], [-0.10, -0.28], [-0.10, -0.12], [-0.28, -0.12]]
categories = ['soda-can']
[places.far]
outline = [[0.38, 0.28], [0.5, 0.28], [0.5, 0.4], [0.38, 0.4]]
[places.unknown]
outline = [[0.0, -0.3], [0.16, -0.3], [0.16, -0.16], [0.0, -0.16]]
";

#[test]
fn object_is_carried_to_its_place_and_stands_there() {
    let sandbox = Sandbox::new();
    sandbox.configure(PLACES);
    let (_folder, source) = scene_file(CAN);
    let daemon = sandbox.start(&["--source", &source]);
    let commander = Commander::new(&sandbox, 1, "anna");
    let picture = sandbox.home().join("place.png");
    let is_placed = (0..N_LOOKS).find_map(|_| {
        let picture = picture.to_str().unwrap();
        let options = ["place", "--at", "side", "--picture", picture];
        let plan = planned(&sandbox, &daemon, &options)?;
        check_shape(&plan, PLACE_PLAN);
        let transport = &plan["transport"];
        let is_placed = transport.is_object()
            && is_lifted(&commander, &transport["to_grasp"], &transport["grasp"])
            && is_set_down(&commander, transport);
        is_placed.then(|| transport.clone())
    });
    let transport = is_placed.expect("the can is carried");
    assert!(!commander.state().is_holding);
    let foot: [f64; 3] = numbers(&transport["placement"]["foot_m"]);
    assert!((-0.28..-0.10).contains(&foot[0]) && (-0.28..-0.12).contains(&foot[1]));
    daemon.wait_for("the can stands at its place", |objects| {
        objects.iter().any(|object| {
            let [x, y, z] = numbers(&object["position_m"]);
            let half_m = 0.5 * object["size_m"][2].as_f64().unwrap_or_default();
            (x - foot[0]).hypot(y - foot[1]) < 0.02 && (z - half_m - foot[2]).abs() < 0.015
        })
    });
    assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    daemon.stop();
}

#[test]
fn places_are_listed_and_what_cannot_be_placed_is_a_sentence() {
    let sandbox = Sandbox::new();
    let (_folder, source) = scene_file(CAN);
    let daemon = sandbox.start(&["--source", &source]);
    let objects = daemon.wait_for("the can is tracked", |objects| !objects.is_empty());
    let track = objects[0]["track_id"].to_string();
    let (code, sentence) = daemon.refused(&["place", "plan", &track]);
    assert_eq!(code, REFUSED, "{sentence}");
    assert!(sentence.contains("[places.NAME]"), "{sentence}");
    sandbox.configure(PLACES);
    let list: Value =
        serde_json::from_slice(&sandbox.tabula(&["place", "list", "--json"]).stdout).unwrap();
    check_list(&list["places"], PLACE_ROW);
    let reached = |index: usize| list["places"][index]["reached"].as_f64().unwrap();
    assert!(reached(0) < 0.5 && reached(1) > 0.9, "{list}");
    for (place, word) in [("far", "reach"), ("shelf", "side")] {
        let output = sandbox.tabula(&["place", "plan", &track, "--at", place]);
        let mut text = String::from_utf8(output.stdout).unwrap();
        text += &String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(REFUSED), "{text}");
        assert!(text.contains(word), "{text}");
    }
    // Without a label the place of unknown objects counts.
    let output = sandbox.tabula(&["place", "plan", &track, "--json"]);
    let plan: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(plan["place"], "unknown", "{plan}");
    daemon.stop();
    let twice = "[places.a]\noutline = [[0, 0], [1, 0], [0, 1]]\ncategories = ['mug']\n\
                 [places.b]\noutline = [[0, 0], [1, 0], [0, 1]]\ncategories = ['mug']\n";
    sandbox.configure(twice);
    let output = sandbox.tabula(&["place", "list"]);
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert!(sentence.contains("two places"), "{sentence}");
    sandbox.configure("[places.a]\noutline = [[0, 0], [1, 0]]\n");
    let output = sandbox.tabula(&["config", "check"]);
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert!(sentence.contains("convex"), "{sentence}");
}

#[test]
fn no_grasp_is_a_sentence_with_its_own_exit_code() {
    let sandbox = Sandbox::new();
    let (_folder, source) = scene_file(FAR);
    let daemon = sandbox.start(&["--source", &source]);
    let objects = daemon.wait_for("the carton is tracked", |objects| !objects.is_empty());
    let track = objects[0]["track_id"].to_string();
    let output = sandbox.tabula(&["grasp", "plan", &track]);
    assert_eq!(output.status.code(), Some(REFUSED));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("out of the arm's reach"), "{text}");
    let (code, sentence) = daemon.refused(&["grasp", "plan", "999999"]);
    assert_eq!(code, REFUSED, "{sentence}");
    assert!(sentence.contains("999999"), "{sentence}");
    daemon.stop();
}

#[test]
fn a_gripper_of_the_configuration_is_checked_and_used() {
    let sandbox = Sandbox::new();
    sandbox.configure("[gripper]\nmax_opening_m = 0.012\n");
    let (_folder, source) = scene_file(BALL);
    let daemon = sandbox.start(&["--source", &source]);
    let objects = daemon.wait_for("the ball is tracked", |objects| !objects.is_empty());
    let track = objects[0]["track_id"].to_string();
    let output = sandbox.tabula(&["grasp", "plan", &track]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(REFUSED), "{text}");
    assert!(text.contains("too wide"), "{text}");
    daemon.stop();
    sandbox.configure("[gripper]\nmax_opening_m = 3.0\n");
    let output = sandbox.tabula(&["config", "check"]);
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert!(sentence.contains("max_opening_m"), "{sentence}");
}
