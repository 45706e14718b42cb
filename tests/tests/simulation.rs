//! Simulated table: detection and tracking scored with ground truth, the arm, and
//! recordings.

use crate::daemon::{Daemon, Sandbox, eventually};
use crate::lockstep::repeatable;
use crate::recorder::{RecordedMessage, RecordedScene, Recorder, SceneRecorder};
use channel::topic::{ArmStates, CameraCloud, PersonBodies, TrueMasks, TrueObjects};
use channel::{Domain, Role, SharedMessage, Subscriber};
use constraint::{Assumption, Assumptions, Constraint, Expression};
use message::{ArmActivity, ProcessKind, SceneObject, TrackState, TrueObject};
use nalgebra::{Point3, Vector3};
use rustix::process::Signal;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Stdio;
use tempfile::TempDir;

/// Number of scored frames, after the warm-up in which tracks are initiated.
const N_SCORED: usize = 60;
const N_WARM_UP: usize = 15;
/// Largest distance between a track and its ground-truth object, metres.
const NEAR_M: f64 = 0.04;
/// Smallest visible area of an object that must be found, pixels.
const PIXELS_MIN: u32 = 300;
/// Exit code of a usage error.
const USAGE: i32 = 2;
const REFUSED: i32 = 4;

/// Scene of six household objects, without arm or person.
const BREAKFAST: &str = "
seed = 11
[[object]]
category = 'mug'
position_m = [-0.30, -0.05]
[[object]]
category = 'cereal-box'
position_m = [0.05, 0.18]
yaw_deg = 20.0
[[object]]
category = 'apple'
position_m = [0.25, -0.10]
[[object]]
category = 'bottle'
position_m = [-0.12, 0.20]
[[object]]
category = 'bowl'
position_m = [0.0, -0.12]
[[object]]
category = 'teapot'
position_m = [0.33, 0.15]
";

/// Scene of a carton within the arm's reach.
pub(crate) const CARTON: &str = "
seed = 3
[arm]
[[object]]
category = 'milk-carton'
position_m = [-0.15, -0.05]
";

/// Scene of a carton, and an apple that a person's hand hides.
const HANDS: &str = "
seed = 3
[[object]]
category = 'milk-carton'
position_m = [-0.15, -0.05]
[[object]]
category = 'apple'
position_m = [0.20, 0.05]
[person]
by_chance = false
[[person.action]]
at_s = 1.0
do = 'hide'
object = 2
for_s = 1.5
";

pub(crate) fn scene_file(text: &str) -> (TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    let source = format!("simulation:{}", path.to_str().unwrap());
    (folder, source)
}

fn middle(position_m: [f64; 3]) -> Point3<f64> {
    Point3::from(position_m)
}

/// Recall, precision, identity switches and position errors against ground truth.
#[derive(Debug, Default)]
struct Score {
    n_true: usize,
    n_found: usize,
    n_tracks: usize,
    n_tracks_of_objects: usize,
    errors_m: Vec<f64>,
    tracks_of_object: BTreeMap<u32, BTreeSet<u64>>,
}

impl Score {
    fn add(&mut self, truth: &[TrueObject], tracks: &[SceneObject]) {
        let seen: Vec<_> = tracks
            .iter()
            .filter(|track| track.state == TrackState::Tracked.code())
            .collect();
        let distance = |object: &TrueObject, track: &SceneObject| {
            let there = middle(object.world_from_object.position_m);
            (there - middle(track.pose.position_m)).norm()
        };
        for object in truth.iter().filter(|o| o.visible_px >= PIXELS_MIN) {
            self.n_true += 1;
            let by_distance = |a: &&&SceneObject, b: &&&SceneObject| {
                distance(object, a).total_cmp(&distance(object, b))
            };
            let Some(track) = seen.iter().min_by(by_distance) else {
                continue;
            };
            if distance(object, track) < NEAR_M {
                self.n_found += 1;
                self.errors_m.push(distance(object, track));
                let tracks = self.tracks_of_object.entry(object.id).or_default();
                tracks.insert(track.track_id);
            }
        }
        self.n_tracks += seen.len();
        let is_object =
            |track: &&&SceneObject| truth.iter().any(|object| distance(object, track) < NEAR_M);
        self.n_tracks_of_objects += seen.iter().filter(is_object).count();
    }

    fn recall(&self) -> f64 {
        self.n_found as f64 / self.n_true as f64
    }

    fn precision(&self) -> f64 {
        self.n_tracks_of_objects as f64 / self.n_tracks as f64
    }

    fn n_id_switches(&self) -> usize {
        let switches = self
            .tracks_of_object
            .values()
            .map(|tracks| tracks.len() - 1);
        switches.sum()
    }

    fn median_error_m(&mut self) -> f64 {
        self.errors_m.sort_by(f64::total_cmp);
        self.errors_m[self.errors_m.len() / 2]
    }
}

/// Pairs scenes with the ground truth of the same frames.
fn paired<'a>(
    scenes: &'a [RecordedScene],
    truths: &'a [RecordedMessage<TrueObjects>],
) -> impl Iterator<Item = (&'a RecordedScene, &'a RecordedMessage<TrueObjects>)> {
    scenes.iter().filter_map(|scene| {
        let key = (scene.header.session, scene.header.sequence);
        let is_same = |truth: &&RecordedMessage<TrueObjects>| {
            (truth.header.session, truth.header.sequence) == key
        };
        Some((scene, truths.iter().find(is_same)?))
    })
}

/// Plays a scene in lockstep and scores it.
fn score(source: &str) -> Score {
    let sandbox = Sandbox::new();
    let scenes = SceneRecorder::start(&sandbox);
    let truths = Recorder::<TrueObjects>::start(&sandbox);
    let daemon = sandbox.start(&["--source", source, "--lockstep"]);
    scenes.wait_for("enough scenes", |s| s.len() > N_WARM_UP + N_SCORED);
    let (scenes, _) = scenes.stop();
    let (truths, _) = truths.stop();
    daemon.stop();
    let mut score = Score::default();
    for (scene, truth) in paired(&scenes, &truths).skip(N_WARM_UP) {
        score.add(&truth.items, &scene.items);
    }
    score
}

#[test]
fn simulated_objects_are_detected_and_tracked() {
    let (_folder, source) = scene_file(BREAKFAST);
    let mut score = score(&source);
    println!(
        "recall {:.3}, precision {:.3}, {} id switches, median error {:.1} mm over {} frames' objects",
        score.recall(),
        score.precision(),
        score.n_id_switches(),
        score.median_error_m() * 1e3,
        score.n_true
    );
    assert!(score.n_true >= 5 * N_SCORED / 2, "{score:?}");
    assert!(score.recall() > 0.95, "{score:?}");
    assert!(score.precision() > 0.9, "{score:?}");
    assert!(score.n_id_switches() <= 1, "{score:?}");
}

#[test]
fn the_mask_belongs_to_the_cloud_of_its_frame() {
    let sandbox = Sandbox::new();
    let domain = Domain::join(&sandbox.domain, &sandbox.run_folder(), Role::Guest).unwrap();
    let mut clouds = Subscriber::<CameraCloud>::polled(&domain).unwrap();
    let truths = Recorder::<TrueObjects>::start(&sandbox);
    let masks = Recorder::<TrueMasks>::start(&sandbox);
    let (_folder, source) = scene_file(BREAKFAST);
    let daemon = sandbox.start(&["--source", &source]);
    let mut cloud = None;
    eventually("a cloud is there", || {
        cloud = clouds.latest().unwrap();
        cloud.is_some()
    });
    let cloud = cloud.unwrap();
    let key = (cloud.header().session, cloud.header().sequence);
    let (mut mask, mut truth) = (None, None);
    eventually("its mask and its objects are there", || {
        mask = masks.find(|mask| (mask.header.session, mask.header.sequence) == key);
        truth = truths.find(|truth| (truth.header.session, truth.header.sequence) == key);
        mask.is_some() && truth.is_some()
    });
    check_mask(&cloud, &mask.unwrap(), &truth.unwrap());
    drop((cloud, clouds));
    masks.stop();
    truths.stop();
    drop(domain);
    daemon.stop();
}

/// Asserts that nearly all points of an object's pixels lie in its box.
fn check_mask(
    cloud: &SharedMessage<CameraCloud>,
    mask: &RecordedMessage<TrueMasks>,
    truth: &RecordedMessage<TrueObjects>,
) {
    let frame = cloud
        .header()
        .checked(cloud.items().len(), u64::MAX)
        .unwrap();
    let world_from_camera = frame.world_from_camera.unwrap();
    let points = message::points(cloud.items());
    assert_eq!(points.len(), mask.items.len());
    for object in &truth.items {
        let object_from_camera =
            object.world_from_object.checked().unwrap().inverse() * world_from_camera;
        let half = Vector3::from(object.size_m).cast::<f64>() / 2.0 + Vector3::repeat(0.012);
        let of_object = points.iter().zip(&mask.items);
        let of_object =
            of_object.filter(|(point, pixel)| u32::from(pixel.0) == object.id && point.is_finite());
        let (mut n_inside, mut n_all) = (0_u32, 0_u32);
        for (point, _) in of_object {
            let at = object_from_camera * point.position();
            n_all += 1;
            n_inside += u32::from((0..3).all(|axis| at[axis].abs() < half[axis]));
        }
        let share = f64::from(n_inside) / f64::from(n_all.max(1));
        assert!(
            n_all > 100 && share > 0.95,
            "{share} of {n_all}: {object:?}"
        );
    }
}

/// Runs an arm command that must succeed.
fn arm(daemon: &Daemon<'_>, arguments: &[&str]) -> Value {
    let report = daemon.ask(&[&["arm"], arguments].concat());
    assert_eq!(report["note"], "", "{arguments:?}: {report:#}");
    report
}

#[test]
fn arm_grasps_lifts_and_releases_an_object() {
    let sandbox = Sandbox::new();
    let truths = Recorder::<TrueObjects>::start(&sandbox);
    let (_folder, source) = scene_file(CARTON);
    // In lockstep the simulated time does not run away from a busy perception.
    let daemon = sandbox.start(&["--source", &source, "--lockstep"]);
    let height = || truths.last().unwrap().items[0].world_from_object.position_m[2];
    daemon.wait_for("the carton is tracked", |objects| !objects.is_empty());
    let standing_m = height();
    arm(&daemon, &["move", "-0.15", "-0.05", "1.12"]);
    arm(&daemon, &["move", "-0.15", "-0.05", "0.93", "--straight"]);
    assert_eq!(arm(&daemon, &["close"])["is_holding"], true);
    arm(&daemon, &["move", "-0.15", "-0.05", "1.08", "--straight"]);
    eventually("the carton is lifted", || height() > standing_m + 0.12);
    let open = arm(&daemon, &["open"]);
    assert_eq!(open["is_holding"], false);
    eventually("the carton has fallen back", || {
        height() < standing_m + 0.05
    });
    let (code, sentence) = daemon.refused(&["arm", "move", "0.9", "0.9", "0.9"]);
    assert_eq!(code, REFUSED, "{sentence}");
    truths.stop();
    daemon.stop();
}

/// Distance from all objects, metres, beyond which a new track is a false positive.
const ASTRAY_M: f64 = 0.10;

/// Reasons of all rejected candidates in some scenes.
fn sentences(scenes: &[RecordedScene]) -> BTreeSet<String> {
    let ignored = scenes
        .iter()
        .flat_map(|scene| scene.header.rejected_candidates());
    let decided = ignored.flat_map(message::RejectedCandidate::decisive_findings);
    decided
        .map(|(_, finding)| finding.reason.to_string())
        .collect()
}

/// False positives: new tracks far from all ground-truth objects.
fn astray(scenes: &[RecordedScene], truths: &[RecordedMessage<TrueObjects>]) -> Vec<SceneObject> {
    let is_astray = |track: &SceneObject, truth: &RecordedMessage<TrueObjects>| {
        let at = middle(track.pose.position_m);
        let is_near = |object: &TrueObject| {
            (middle(object.world_from_object.position_m) - at).norm() < ASTRAY_M
        };
        !truth.items.iter().any(is_near)
    };
    let begun = paired(scenes, truths).flat_map(|(scene, truth)| {
        let capture_ns = scene.header.stamps.capture_ns;
        let new = scene.items.iter();
        let new = new.filter(move |track| track.first_seen_ns == capture_ns);
        new.filter(|track| is_astray(track, truth))
    });
    begun.copied().collect()
}

#[test]
fn arm_over_the_table_is_rejected_with_a_reason() {
    let sandbox = Sandbox::new();
    let scenes = SceneRecorder::start(&sandbox);
    let truths = Recorder::<TrueObjects>::start(&sandbox);
    let (_folder, source) = scene_file(CARTON);
    let daemon = sandbox.start(&["--source", &source, "--lockstep"]);
    daemon.wait_for("the carton is tracked", |objects| !objects.is_empty());
    arm(&daemon, &["move", "-0.15", "-0.05", "1.12"]);
    arm(&daemon, &["move", "-0.05", "-0.15", "0.98"]);
    let mut reported = Value::Null;
    eventually("the arm is ignored", || {
        reported = daemon.ask(&["objects"]);
        reported["ignored"].as_array().is_some_and(|ignored| {
            let of_arm = |blob: &Value| blob["why"].to_string().contains("the robot's arm");
            ignored.iter().any(of_arm)
        })
    });
    assert_eq!(reported["rule"], Expression::default().to_string());
    for blob in reported["ignored"].as_array().unwrap() {
        let keys: BTreeSet<_> = blob
            .as_object()
            .unwrap()
            .keys()
            .map(String::as_str)
            .collect();
        let expected = [
            "position_m",
            "orientation_xyzw",
            "size_m",
            "n_points",
            "verdict",
            "why",
            "findings",
        ];
        assert_eq!(keys, BTreeSet::from(expected));
        assert_eq!(blob["findings"].as_array().unwrap().len(), Constraint::N);
    }
    // The simulation publishes the arm, the absence of people, the up direction and the
    // camera pose: detection assumes nothing.
    assert_eq!(
        reported["assumptions"],
        serde_json::json!([]),
        "{reported:#}"
    );
    let text = sandbox.tabula(&["objects"]);
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(text.contains("ignored at ("), "{text}");
    assert!(text.contains("it is the robot's arm ("), "{text}");
    let (scenes, _) = scenes.stop();
    let (truths, _) = truths.stop();
    daemon.stop();
    let astray = astray(&scenes, &truths);
    assert!(astray.is_empty(), "{astray:#?}");
}

#[test]
fn hand_at_an_object_is_rejected_and_starts_no_track() {
    let sandbox = Sandbox::new();
    let scenes = SceneRecorder::start(&sandbox);
    let truths = Recorder::<TrueObjects>::start(&sandbox);
    let (_folder, source) = scene_file(HANDS);
    let daemon = sandbox.start(&["--source", &source, "--lockstep"]);
    scenes.wait_for("the hand has come and gone", |scenes| scenes.len() >= 150);
    let (scenes, _) = scenes.stop();
    let (truths, _) = truths.stop();
    daemon.stop();
    let sentences = sentences(&scenes);
    assert!(
        sentences.iter().any(|one| one.contains("it is a person")),
        "{sentences:#?}"
    );
    let astray = astray(&scenes, &truths);
    assert!(astray.is_empty(), "{astray:#?}");
    let without_arm = Assumptions::from_bits(scenes[100].header.assumptions);
    let assumed: Vec<_> = without_arm.iter().collect();
    assert_eq!(assumed, [Assumption::NoRobotKnown]);
}

#[test]
fn candidate_rule_with_an_unknown_constraint_is_refused_at_the_start() {
    let sandbox = Sandbox::new();
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("tabula.toml");
    let text = "[perception]\ncandidate_rule = 'C_table and C_tarck'\n";
    std::fs::write(&config, text).unwrap();
    let config = config.to_str().unwrap();
    let (code, sentence) = refused(&sandbox, &["run", "--check-config", "--config", config]);
    assert_eq!(code, USAGE, "{sentence}");
    for word in [
        "candidate_rule",
        "C_tarck",
        "character 13",
        "C_track may be meant",
    ] {
        assert!(sentence.contains(word), "{sentence}");
    }
}

#[test]
fn stop_brakes_at_once() {
    let sandbox = Sandbox::new();
    let states = Recorder::<ArmStates>::start(&sandbox);
    let (_folder, source) = scene_file(CARTON);
    let daemon = sandbox.start(&["--source", &source]);
    let moving = sandbox
        .command("tabula")
        .args(["arm", "move", "-0.15", "-0.05", "1.12"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let is_moving = |state: &RecordedMessage<ArmStates>| {
        state.header.activity == ArmActivity::Moving.code()
            && state
                .header
                .joint_velocities_rad_s
                .iter()
                .any(|v| v.abs() > 0.3)
    };
    states.wait_for("the arm moves", |states| states.iter().any(is_moving));
    let stopped = arm(&daemon, &["stop"]);
    assert_eq!(stopped["activity"], "stopped");
    let n_before = states.len();
    states.wait_for("the arm says how it stands", |s| s.len() > n_before + 30);
    let (states, _) = states.stop();
    let moving = moving.wait_with_output().unwrap();
    let sentence = String::from_utf8(moving.stderr).unwrap();
    assert_eq!(moving.status.code(), Some(REFUSED), "{sentence}");
    assert!(sentence.contains("was stopped"), "{sentence}");
    daemon.stop();
    // States from before the answer may still have been under way; from the first one that says so
    // on, the arm brakes, and then stands.
    let is_stopped =
        |state: &RecordedMessage<ArmStates>| state.header.activity == ArmActivity::Stopped.code();
    let stop = states.iter().position(is_stopped).unwrap();
    let last = states.last().unwrap();
    assert_eq!(last.header.activity, ArmActivity::Stopped.code());
    assert_eq!(last.header.joint_velocities_rad_s, [0.0; 6]);
    for pair in states[stop..].windows(2) {
        let speeds =
            |state: &RecordedMessage<ArmStates>| state.header.joint_velocities_rad_s.map(f64::abs);
        let (before, after) = (speeds(&pair[0]), speeds(&pair[1]));
        for (before, after) in before.iter().zip(after) {
            assert!(after <= *before, "it moves on: {:?}", pair[1].header);
        }
    }
    assert!(!last.items.is_empty(), "the links have capsules");
}

#[test]
fn default_source_is_a_table_with_an_arm_and_a_person() {
    let sandbox = Sandbox::new();
    let bodies = Recorder::<PersonBodies>::start(&sandbox);
    let daemon = sandbox.start(&[]);
    daemon.wait_for("objects are tracked", |objects| objects.len() >= 2);
    let objects = daemon.ask(&["objects"]);
    let source = objects["source_name"].as_str().unwrap().to_owned();
    assert!(source.starts_with("simulation:everyday"), "{source}");
    assert_eq!(daemon.ask(&["arm", "state"])["activity"], "idle");
    bodies.wait_for("the person's body is published", |bodies| {
        bodies.last().is_some_and(|body| body.items.len() >= 5)
    });
    bodies.stop();
    daemon.stop();
}

#[test]
fn in_lockstep_the_same_seed_gives_the_same_world() {
    let run = || {
        let sandbox = Sandbox::new();
        let scenes = SceneRecorder::start(&sandbox);
        let daemon = sandbox.start(&["--source", "simulation", "--seed", "9", "--lockstep"]);
        scenes.wait_for("enough scenes", |scenes| scenes.len() >= 40);
        let (scenes, _) = scenes.stop();
        daemon.stop();
        scenes
    };
    let (first, second) = (run(), run());
    for (first, second) in first.iter().zip(&second).take(40) {
        assert_eq!(repeatable(first), repeatable(second));
    }
}

#[test]
fn killed_simulator_is_restarted() {
    let sandbox = Sandbox::new();
    let (_folder, source) = scene_file(BREAKFAST);
    let daemon = sandbox.start(&["--source", &source]);
    daemon.wait_for("objects are tracked", |objects| objects.len() >= 4);
    let killed = daemon.pid(ProcessKind::SIMULATOR).unwrap();
    daemon.signal(ProcessKind::SIMULATOR, Signal::KILL);
    eventually("another simulator runs", || {
        let pid = daemon.pid(ProcessKind::SIMULATOR);
        let frames = daemon.health(ProcessKind::SIMULATOR.word());
        pid.is_some_and(|pid| pid != killed)
            && frames.is_some_and(|health| health["frames"].as_u64() > Some(10))
    });
    daemon.wait_for("objects are tracked again", |objects| {
        objects.iter().filter(|o| o["state"] == "tracked").count() >= 4
    });
    daemon.stop();
}

#[test]
fn recorded_simulation_is_replayed() {
    let sandbox = Sandbox::new();
    let (folder, source) = scene_file(BREAKFAST);
    let scene = source.strip_prefix("simulation:").unwrap();
    let out = folder.path().join("sequence");
    let out = out.to_str().unwrap();
    let output = sandbox.tabula(&["simulate", "scene", scene, "--frames", "20", "--out", out]);
    assert!(output.status.success(), "{output:?}");
    let files = |suffix: &str| {
        let names = std::fs::read_dir(out)
            .unwrap()
            .map(|e| e.unwrap().file_name());
        names
            .filter(|name| name.to_string_lossy().ends_with(suffix))
            .count()
    };
    for suffix in [
        "color.png",
        "depth.png",
        "pose.txt",
        "mask.png",
        "truth.json",
    ] {
        assert_eq!(files(suffix), 20, "{suffix}");
    }
    let daemon = sandbox.start(&["--source", out, "--loop"]);
    daemon.wait_for("objects are tracked", |objects| {
        objects.iter().filter(|o| o["state"] == "tracked").count() >= 4
    });
    daemon.stop();
}

#[test]
fn simulated_views_are_written_for_learning() {
    let sandbox = Sandbox::new();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let words =
        "--json simulate views --category mug --category cereal-box --instances 2 --views 6";
    let arguments: Vec<&str> = words.split(' ').chain(["--out", out]).collect();
    let output = sandbox.tabula(&arguments);
    assert!(output.status.success(), "{output:?}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["objects"], 4, "{report:#}");
    assert!(report["views"].as_u64() >= Some(22), "{report:#}");
    assert!(report["mean_overlap"].as_f64() > Some(0.7), "{report:#}");
    let dataset = dataset::washington::ObjectDataset::open(folder.path()).unwrap();
    assert_eq!(dataset.n_views() as u64, report["views"].as_u64().unwrap());
    let (code, sentence) = refused(
        &sandbox,
        &["simulate", "views", "--category", "unicorn", "--out", out],
    );
    assert_eq!(code, USAGE);
    assert!(sentence.contains("unicorn"), "{sentence}");
}

#[test]
fn tracking_evaluation_compares_with_ground_truth() {
    let sandbox = Sandbox::new();
    let (folder, source) = scene_file(&format!("duration_s = 1.0\n{BREAKFAST}"));
    let scene = source.strip_prefix("simulation:").unwrap();
    let out = folder.path().join("tracks");
    let out = out.to_str().unwrap();
    let words = ["--json", "evaluate", "tracking", scene, "--seeds", "1"];
    let output = sandbox.tabula(&[&words[..], &["--out", out]].concat());
    assert!(output.status.success(), "{output:?}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["n_objects"], 6, "{report:#}");
    assert_eq!(report["id_switches"], 0, "{report:#}");
    for key in ["mota", "idf1"] {
        assert!(report[key].as_f64() > Some(0.8), "{report:#}");
    }
    let centre_mm = &report["centre_error_mm"]["median"];
    assert!(centre_mm.as_f64() < Some(15.0), "{report:#}");
    let unknown = ["evaluate", "tracking", "--scene", "dance", "--out", out];
    let (code, sentence) = refused(&sandbox, &unknown);
    assert_eq!(code, USAGE);
    assert!(sentence.contains("crossing"), "{sentence}");
}

fn refused(sandbox: &Sandbox, arguments: &[&str]) -> (i32, String) {
    let output = sandbox.tabula(arguments);
    assert!(!output.status.success(), "{arguments:?}: {output:?}");
    let sentence = String::from_utf8(output.stderr).unwrap();
    (output.status.code().unwrap(), sentence)
}

#[test]
fn invalid_scenes_are_refused_at_the_start() {
    let sandbox = Sandbox::new();
    let check = |source: &str, word: &str| {
        let (code, sentence) = refused(&sandbox, &["run", "--source", source]);
        assert_eq!(code, USAGE, "{sentence}");
        assert!(sentence.contains(word), "{sentence}");
    };
    check("simulation:palace", "palace");
    check("simulation:", "scene");
    check("simulation:/nowhere.toml", "/nowhere.toml");
    for (text, word) in [
        (
            "[[object]]\ncategory = 'unicorn'\nposition_m = [0, 0]",
            "unicorn",
        ),
        ("[table]\nheight_m = nan", "height_m"),
        ("[[object]]\nposition_m = [0, 0]", "category"),
        ("wheels = 4", "wheels"),
    ] {
        let (_folder, source) = scene_file(text);
        check(&source, word);
    }
    let (code, sentence) = refused(&sandbox, &["run", "--loop"]);
    assert_eq!(code, USAGE, "{sentence}");
    assert!(sentence.contains("--loop"), "{sentence}");
    assert!(
        !Path::new(sandbox.home()).exists()
            || std::fs::read_dir(sandbox.home()).unwrap().next().is_none()
    );
}
