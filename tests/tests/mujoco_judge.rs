//! Judge of grasps by MuJoCo: a good grasp holds, a miss does not, a container is one, and rubbish is
//! answered. The environment is that of the first use.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Judge in a process of its own.
struct Judge {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Judge {
    fn start() -> Self {
        let program = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/mujoco-grasps/run");
        let mut command = Command::new(program);
        command
            .arg("--serve")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let (to, from) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        let from = BufReader::new(from);
        Self { child, to, from }
    }

    fn ask_line(&mut self, line: &str) -> Value {
        writeln!(self.to, "{line}").unwrap();
        self.to.flush().unwrap();
        let mut answer = String::new();
        self.from.read_line(&mut answer).unwrap();
        serde_json::from_str(&answer).unwrap()
    }

    fn ask(&mut self, document: &Value) -> Value {
        self.ask_line(&document.to_string())
    }

    /// Closing standard input ends the judge.
    fn stop(mut self) {
        drop(self.to);
        assert!(self.child.wait().unwrap().success());
    }
}

/// Corners of a box by its middle and half sides.
fn cuboid([x, y, z]: [f64; 3], [a, b, c]: [f64; 3]) -> Vec<[f64; 3]> {
    let signs = [-1.0, 1.0];
    let corners = signs.iter().flat_map(|i| {
        signs
            .iter()
            .flat_map(move |j| signs.map(|k| [x + i * a, y + j * b, z + k * c]))
    });
    corners.collect()
}

fn object(id: u32, parts: &[Vec<[f64; 3]>], pose: [f64; 7]) -> Value {
    json!({"id": id, "parts": parts, "pose": pose, "density_kg_m3": 300.0, "friction": 0.5})
}

fn world(objects: &[Value]) -> Value {
    json!({"world": {"table_m": 0.7, "objects": objects, "gripper": {
        "max_opening_m": 0.15, "pad_length_m": 0.05, "pad_width_m": 0.022,
        "pad_thickness_m": 0.006, "finger_thickness_m": 0.012, "palm_m": 0.08,
        "opening_speed_m_s": 0.12, "closing_force_n": 25.0, "pad_friction": 0.6,
    }}})
}

/// Grasp from above at a place, closing along x.
fn grasp(x: f64, z: f64, opening_m: f64) -> Value {
    json!({"grasp": {
        "pose": [x, 0.0, z, 1.0, 0.0, 0.0, 0.0],
        "opening_m": opening_m, "approach_m": 0.1, "target": 1,
    }})
}

#[test]
fn mujoco_judge_holds_what_is_grasped_well_and_no_miss() {
    let mut judge = Judge::start();
    let carton = object(
        1,
        &[cuboid([0.0; 3], [0.03, 0.02, 0.05])],
        [0.0, 0.0, 0.75, 0.0, 0.0, 0.0, 1.0],
    );
    judge.ask(&world(std::slice::from_ref(&carton)));
    let held = judge.ask(&grasp(0.0, 0.76, 0.10));
    assert_eq!(held["held"], true, "{held}");
    assert!(held["risen_m"].as_f64().unwrap() > 0.15, "{held}");
    judge.ask(&world(std::slice::from_ref(&carton)));
    let missed = judge.ask(&grasp(0.0, 0.86, 0.10));
    assert_eq!(missed["held"], false, "{missed}");
    // A thin rod, which a finger without inertia would be pressed through.
    let rod = object(
        1,
        &[cuboid([0.0; 3], [0.006, 0.08, 0.006])],
        [0.0, 0.0, 0.706, 0.0, 0.0, 0.0, 1.0],
    );
    judge.ask(&world(&[rod]));
    let held = judge.ask(&grasp(0.0, 0.728, 0.05));
    assert_eq!(held["held"], true, "{held}");
    judge.stop();
}

#[test]
fn mujoco_judge_lets_a_ball_fall_into_a_box_of_parts() {
    let mut judge = Judge::start();
    let wall = |x: f64, y: f64, a: f64, b: f64| cuboid([x, y, 0.0], [a, b, 0.03]);
    let tray = [
        wall(0.05, 0.0, 0.003, 0.05),
        wall(-0.05, 0.0, 0.003, 0.05),
        wall(0.0, 0.05, 0.05, 0.003),
        wall(0.0, -0.05, 0.05, 0.003),
        cuboid([0.0, 0.0, -0.028], [0.05, 0.05, 0.002]),
    ];
    let tray = object(1, &tray, [0.0, 0.0, 0.73, 0.0, 0.0, 0.0, 1.0]);
    let cube = object(
        2,
        &[cuboid([0.0; 3], [0.015; 3])],
        [0.0, 0.0, 0.78, 0.0, 0.0, 0.0, 1.0],
    );
    let settled = judge.ask(&world(&[tray, cube]));
    let height_m = settled["poses"]["2"][2].as_f64().unwrap();
    assert!((height_m - 0.719).abs() < 0.004, "{settled}");
    judge.stop();
}

#[test]
fn mujoco_judge_answers_rubbish_with_an_error() {
    let mut judge = Judge::start();
    for rubbish in ["{", "[]", "{\"grasp\": 1}", "{\"world\": {}}"] {
        let answer = judge.ask_line(rubbish);
        assert!(answer["error"].is_string(), "{rubbish}: {answer}");
    }
    judge.stop();
}
