//! Real Kinect scenes: recognition after a restart, and static tracks under a moving
//! camera.

use crate::daemon::{Daemon, Sandbox, nearest};
use crate::recorder::{RecordedScene, SceneRecorder};
use message::{ProcessKind, SceneObject, TrackState, frame_flag};
use nalgebra::{Point3, center, distance};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Scene numbers: lying boxes, stacked boxes, boxes that hide each other, cylinders.
const SCENES: [usize; 4] = [7, 21, 28, 44];
/// Whole objects of these scenes by their ground truth.
const N_OBJECTS: usize = 10;
/// Scene with a bowl, a cylinder and a box, of which the first is taught.
const DIFFERENT_SHAPES: usize = 35;
/// Number of frames of the kitchen sequence, at 30 Hz.
const N_KITCHEN_FRAMES: u64 = 300;
/// Life of a track, seconds, above which it must keep its position.
const LONG_LIFE_S: f64 = 2.0;
/// Largest position drift of any track, metres: the box of the visible part grows while
/// an object comes into view.
const WANDER_MAX_M: f64 = 0.12;
/// Largest median position drift, metres.
const WANDER_USUAL_M: f64 = 0.04;

/// Starts a daemon that plays one scene endlessly.
fn show(sandbox: &Sandbox, scene: usize) -> Daemon<'_> {
    let folder = test_data::path("tabletop-scenes");
    let (from, to) = (scene.to_string(), (scene + 1).to_string());
    let source = folder.to_str().unwrap();
    sandbox.start(&[
        "--source", source, "--from", &from, "--to", &to, "--loop", "--rate", "10",
    ])
}

/// Views of an object after which all objects of a still scene have a track: one beside a larger
/// object has to be found for half a second first.
const N_VIEWS_SETTLED: u64 = 30;

/// Waits until all objects of a still scene are tracked.
fn settled(daemon: &Daemon<'_>) -> Vec<Value> {
    daemon.wait_for("all objects are tracked", |objects| {
        let is_settled = |object: &Value| {
            object["state"] == "tracked" && object["n_views"].as_u64() >= Some(N_VIEWS_SETTLED)
        };
        !objects.is_empty() && objects.iter().all(is_settled)
    })
}

fn position(object: &Value) -> [f64; 3] {
    let axes = object["position_m"].as_array().unwrap();
    [0, 1, 2].map(|i| axes[i].as_f64().unwrap())
}

fn id(object: &Value) -> u64 {
    object["track_id"].as_u64().unwrap()
}

/// Labels every object of a scene, restarts the daemon, and asserts each label at its
/// position; returns the number of objects.
fn check_known_again(scene: usize) -> usize {
    let sandbox = Sandbox::new();
    let daemon = show(&sandbox, scene);
    let taught = settled(&daemon);
    for object in &taught {
        let track_id = object["track_id"].to_string();
        daemon.ask(&["teach", &track_id, &format!("thing {track_id}")]);
    }
    daemon.stop();
    let daemon = show(&sandbox, scene);
    let again = settled(&daemon);
    assert_eq!(again.len(), taught.len(), "scene {scene}: {again:#?}");
    let newest_taught = taught.iter().map(id).max();
    for object in &taught {
        let found = nearest(&again, position(object));
        let name = format!("thing {}", id(object));
        assert_eq!(found["label"], name.as_str(), "scene {scene}: {found:#}");
        assert!(
            Some(id(found)) > newest_taught,
            "a track-id is used twice: {found:#}"
        );
    }
    daemon.stop();
    taught.len()
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn labels_of_real_objects_are_recognised_after_a_restart() {
    let n_objects: usize = SCENES.into_iter().map(check_known_again).sum();
    println!(
        "{n_objects} objects of {} scenes were known again",
        SCENES.len()
    );
    assert!(n_objects >= N_OBJECTS, "only {n_objects} objects were seen");
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn real_objects_of_another_shape_stay_unknown() {
    let sandbox = Sandbox::new();
    let daemon = show(&sandbox, DIFFERENT_SHAPES);
    let objects = settled(&daemon);
    assert!(objects.len() >= 3, "{objects:#?}");
    let taught = id(&objects[0]);
    daemon.ask(&["teach", &taught.to_string(), "first"]);
    let label = |objects: &[Value], wanted: u64| {
        objects
            .iter()
            .find(|object| id(object) == wanted)
            .map(|object| object["label"].clone())
    };
    let objects = daemon.wait_for("what was taught is named", |objects| {
        label(objects, taught) == Some("first".into())
    });
    for object in objects.iter().filter(|object| id(object) != taught) {
        println!(
            "track {}: distance {}",
            object["track_id"], object["distance"]
        );
        assert_eq!(object["label"], Value::Null, "{object:#}");
        assert!(
            object["distance"].is_number(),
            "it was compared: {object:#}"
        );
    }
    daemon.stop();
}

/// Trajectory of a track: capture times in seconds and positions, where it was fully
/// visible.
type Trajectory = Vec<(f64, Point3<f64>)>;

/// Trajectories of the tracks, without views cut by the image border.
fn paths(scenes: &[RecordedScene]) -> BTreeMap<u64, Trajectory> {
    let mut paths = BTreeMap::<u64, Trajectory>::new();
    for scene in scenes {
        let time_s = scene.header.stamps.capture_ns as f64 * 1e-9;
        let is_whole = |object: &&SceneObject| {
            object.state == TrackState::Tracked.code() && object.cut_by_image == 0
        };
        for object in scene.items.iter().filter(is_whole) {
            let path = paths.entry(object.track_id).or_default();
            path.push((time_s, Point3::from(object.pose.position_m)));
        }
    }
    paths
}

/// Largest distance of a trajectory from its middle, metres.
fn wandering_m(path: &Trajectory) -> f64 {
    let lowest = path
        .iter()
        .fold(path[0].1, |low, (_, position)| low.inf(position));
    let highest = path
        .iter()
        .fold(path[0].1, |high, (_, position)| high.sup(position));
    let middle = center(&lowest, &highest);
    path.iter()
        .map(|(_, position)| distance(&middle, position))
        .fold(0.0, f64::max)
}

/// Scenes of the kitchen sequence, played in lockstep so that no frame is dropped;
/// capture times are those of 30 Hz.
fn kitchen(sandbox: &Sandbox, sequence: &str) -> Vec<RecordedScene> {
    let folder = test_data::path(sequence);
    let recorder = SceneRecorder::start(sandbox);
    let to = N_KITCHEN_FRAMES.to_string();
    let daemon = sandbox.start(&[
        "--source",
        folder.to_str().unwrap(),
        "--to",
        &to,
        "--lockstep",
    ]);
    recorder.wait_for("the sequence ends", |_| {
        let camera = daemon.health(ProcessKind::CAMERA.word());
        camera.is_some_and(|camera| camera["state"] == "idle")
    });
    let (scenes, _) = recorder.stop();
    daemon.stop();
    scenes
}

/// Asserts that the frames of a sequence carry poses and are 1/30 s apart.
fn check_headers(scenes: &[RecordedScene]) {
    let has_pose =
        |scene: &RecordedScene| scene.header.frame_flags & frame_flag::HAS_WORLD_POSE != 0;
    assert!(scenes.iter().all(has_pose));
    let captures = scenes.windows(2).map(|pair| {
        let [first, second] = [&pair[0].header, &pair[1].header];
        let elapsed_ns = second.stamps.capture_ns - first.stamps.capture_ns;
        elapsed_ns as f64 * 1e-9 / (second.sequence - first.sequence) as f64
    });
    for period_s in captures {
        assert!(
            (period_s - 1.0 / 30.0).abs() < 1e-6,
            "frames are {period_s} s apart"
        );
    }
}

/// Position drift of each track that lives long, metres; asserts the limit of each.
fn long_lived_drifts_m(scenes: &[RecordedScene]) -> Vec<f64> {
    let life_s = |path: &Trajectory| path.last().unwrap().0 - path[0].0;
    let paths = paths(scenes);
    let long_lived = paths
        .iter()
        .filter(|(_, path)| life_s(path) > LONG_LIFE_S)
        .map(|(track_id, path)| {
            let (life_s, drift_m) = (life_s(path), wandering_m(path));
            println!(
                "track {track_id}: {life_s:.1} s, within {:.0} mm",
                1e3 * drift_m
            );
            assert!(
                drift_m < WANDER_MAX_M,
                "track {track_id} wanders by {drift_m} m"
            );
            drift_m
        });
    long_lived.collect()
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn static_objects_keep_their_position_while_the_camera_moves() {
    let sandbox = Sandbox::new();
    let ids = |scenes: &[RecordedScene]| -> BTreeSet<u64> {
        let objects = scenes.iter().flat_map(|scene| &scene.items);
        objects.map(|object| object.track_id).collect()
    };
    let mut used = BTreeSet::new();
    let mut drifts_m = Vec::new();
    for sequence in ["kitchen-sequence", "kitchen-sequence-2"] {
        let scenes = kitchen(&sandbox, sequence);
        check_headers(&scenes);
        drifts_m.extend(long_lived_drifts_m(&scenes));
        let own = ids(&scenes);
        assert!(used.is_disjoint(&own), "a track-id is used twice");
        used.extend(own);
    }
    assert!(
        drifts_m.len() >= 3,
        "only {} tracks live long",
        drifts_m.len()
    );
    drifts_m.sort_by(f64::total_cmp);
    assert!(
        drifts_m[drifts_m.len() / 2] < WANDER_USUAL_M,
        "{drifts_m:?}"
    );
}
