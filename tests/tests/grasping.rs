//! `tabula grasp plan`: a planned grasp is carried out by the simulated arm, and no grasp is a
//! sentence.

use crate::arm_stop::Commander;
use crate::command_line::{JsonType, check_list, check_shape};
use crate::daemon::{Daemon, Sandbox};
use crate::simulation::scene_file;
use JsonType::{Count, Document, List, Number, Text, TextOrNull, Truth, Vector};
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
    ("frame_sequence", Count),
    ("source_name", Text),
    ("has_world_pose", Truth),
    ("notes", List),
    ("processing_ms", Number),
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

/// Plan of the one object of a scene.
fn plan(sandbox: &Sandbox, daemon: &Daemon<'_>, picture: &Path) -> Value {
    let objects = daemon.wait_for("the object is tracked", |objects| !objects.is_empty());
    let track = objects[0]["track_id"].to_string();
    let picture = picture.to_str().unwrap();
    let options = ["grasp", "plan", &track, "--picture", picture, "--json"];
    let plan: Value = serde_json::from_slice(&sandbox.tabula(&options).stdout).unwrap();
    check_shape(&plan, PLAN);
    check_list(&plan["grasps"], GRASP);
    check_list(&plan["reasons"], REASON);
    check_list(&plan["rejected"], REJECTED);
    plan
}

/// Carries out a grasp; true if the object is held after the lift.
fn carry_out(commander: &Commander<'_>, grasp: &Value) -> bool {
    let straight_to = |position: &str| ArmMotion::MoveTo {
        position_m: numbers(&grasp[position]),
        orientation_xyzw: numbers(&grasp["orientation_xyzw"]),
        straight: true,
    };
    let opening_m = 1e-3 * grasp["opening_mm"].as_f64().unwrap();
    let motions = [
        ArmMotion::OpenTo { opening_m },
        ArmMotion::MoveJoints {
            angles_rad: numbers(&grasp["approach_rad"]),
        },
        straight_to("position_m"),
        ArmMotion::Close,
        straight_to("lift_position_m"),
    ];
    motions.into_iter().all(|motion| {
        let report = commander.carry_out(motion);
        println!("{}: {}", report.activity, report.note);
        report.activity == "idle"
    }) && commander.state().is_holding
}

#[test]
fn planned_grasp_lifts_the_object_after_few_looks() {
    let sandbox = Sandbox::new();
    let (_folder, source) = scene_file(CAN);
    let daemon = sandbox.start(&["--source", &source]);
    let picture = sandbox.home().join("grasp.png");
    let commander = Commander::new(&sandbox, 1, "anna");
    let is_lifted = (0..N_LOOKS).any(|_| {
        let plan = plan(&sandbox, &daemon, &picture);
        let best = plan["grasps"].as_array().and_then(|grasps| grasps.first());
        let is_lifted = best.is_some_and(|grasp| carry_out(&commander, grasp));
        if !is_lifted {
            commander.carry_out(ArmMotion::Open);
            commander.carry_out(ArmMotion::Home);
        }
        is_lifted
    });
    assert!(is_lifted);
    assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    daemon.stop();
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
