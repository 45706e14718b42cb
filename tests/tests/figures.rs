//! The figures the project reports, measured on real data and printed. Nothing
//! here depends on how fast the machine is.

use crate::daemon::{Daemon, Place, WITH_CAMERA, eventually};
use crate::real_data;
use crate::recorder::{Recorded, SceneRecorder};
use channel::domain_reservation;
use dataset::pcd;
use dataset::scene_folder::SceneFolder;
use geometry::{OrientedBox, RigidTransform};
use message::{ProcessKind, SceneObject, StageStamps, TrackState};
use nalgebra::{Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rustix::time::{ClockId, clock_gettime};
use std::collections::BTreeMap;

/// Scenes shown from the folder for the latencies, at 30 Hz.
const N_SCENES_SHOWN: usize = 300;
/// Scenes at the start that do not count: the first ones meet cold memory.
const N_WARM_UP: usize = 30;
/// Cold starts measured.
const N_COLD_STARTS: usize = 5;
/// Labelled objects with fewer pixels are not counted.
const MIN_PIXELS: usize = 300;
/// How far outside a track's box a labelled object's centroid may lie, metres.
const BOX_MARGIN_M: f64 = 0.01;
/// The scene whose objects are taught before anything is measured.
const TAUGHT_SCENE: usize = 35;

fn monotonic_ns() -> u64 {
    let now = clock_gettime(ClockId::Monotonic);
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

fn source(name: &str) -> String {
    real_data::folder(name).to_str().unwrap().to_owned()
}

/// Teaches the objects of one scene, so that there is something to recognise.
fn teach_something(place: &Place) {
    let daemon = show_one(place, TAUGHT_SCENE);
    let objects = daemon.wait_for("objects are tracked", |objects| {
        objects.len() >= 3 && objects.iter().all(|object| object["state"] == "tracked")
    });
    for object in &objects {
        let track_id = object["track_id"].to_string();
        daemon.ask(&["teach", &track_id, &format!("thing {track_id}")]);
    }
    daemon.stop();
}

fn show_one(place: &Place, scene: usize) -> Daemon<'_> {
    let (from, to) = (scene.to_string(), (scene + 1).to_string());
    place.start(&[
        "--source",
        &source("tabletop-scenes"),
        "--from",
        &from,
        "--to",
        &to,
        "--loop",
    ])
}

/// p50, p99 and the largest of durations, milliseconds.
fn percentiles(mut durations_ns: Vec<u64>) -> String {
    durations_ns.sort_unstable();
    let at = |share: f64| {
        let i = ((durations_ns.len() - 1) as f64 * share).round() as usize;
        durations_ns[i] as f64 * 1e-6
    };
    format!("{:7.2} {:7.2} {:7.2}", at(0.5), at(0.99), at(1.0))
}

/// One line for each stage, counted from the camera's publication, and one for
/// the whole way from the scheduled instant.
fn print_latencies(scenes: &[Recorded]) {
    type Stamp = fn(&StageStamps) -> u64;
    let stages: [(&str, Stamp, Stamp); 5] = [
        ("received", |s| s.camera_published_ns, |s| s.received_ns),
        ("detected", |s| s.camera_published_ns, |s| s.detected_ns),
        ("recognised", |s| s.camera_published_ns, |s| s.recognised_ns),
        (
            "label published",
            |s| s.camera_published_ns,
            |s| s.published_ns,
        ),
        ("... from schedule", |s| s.scheduled_ns, |s| s.published_ns),
    ];
    println!(
        "    {:18} {:>7} {:>7} {:>7}",
        "ms after the frame", "p50", "p99", "max"
    );
    for (name, from, to) in stages {
        let stamps = scenes.iter().map(|scene| &scene.header.stamps);
        let durations = stamps
            .map(|s| to(s).checked_sub(from(s)).unwrap())
            .collect();
        println!("    {name:18} {}", percentiles(durations));
    }
}

fn print_health(daemon: &Daemon<'_>) {
    let n_bytes: u64 = domain_reservation()
        .iter()
        .map(channel::Reservation::bytes)
        .sum();
    println!(
        "    shared memory: {:.1} MB for the whole domain",
        n_bytes as f64 * 1e-6
    );
    for process in WITH_CAMERA {
        let health = daemon.health(process.name()).unwrap();
        let megabytes = |name: &str| health[name].as_u64().unwrap() as f64 * 1e-6;
        println!(
            "    {:10} {} frames, {} dropped, {} late; {:.1} MB resident, {:.1} MB reserved",
            process.name(),
            health["frames"],
            health["frames_dropped"],
            health["frames_late"],
            megabytes("resident_bytes"),
            megabytes("shared_memory_bytes"),
        );
    }
}

fn measure_latency(place: &Place, name: &str, looped: bool) {
    let recorder = SceneRecorder::start(place);
    let source = source(name);
    let arguments = ["--source", &source, "--rate", "30", "--loop"];
    let daemon = place.start(&arguments[..if looped { 5 } else { 4 }]);
    let is_over = || {
        let camera = daemon.health(ProcessKind::Camera.name());
        let is_idle = camera.is_some_and(|camera| camera["state"] == "idle");
        is_idle || recorder.is(|scenes| scenes.len() >= N_SCENES_SHOWN) && looped
    };
    eventually("enough scenes", is_over);
    println!("{name}");
    print_health(&daemon);
    let (scenes, n_lost) = recorder.stop();
    daemon.stop();
    let n_late: u32 = scenes.iter().map(|scene| scene.header.n_late).sum();
    let n_objects: usize = scenes.iter().map(|scene| scene.items.len()).sum();
    println!(
        "    {} scenes ({n_lost} not recorded), {:.1} objects in each, {n_late} views late",
        scenes.len(),
        n_objects as f64 / scenes.len() as f64,
    );
    print_latencies(&scenes[N_WARM_UP..]);
}

/// From the start of `tabula run` to the first scene with a label, milliseconds.
fn cold_start_ms(place: &Place) -> f64 {
    let recorder = SceneRecorder::start(place);
    let began_ns = monotonic_ns();
    let daemon = show_one(place, TAUGHT_SCENE);
    let has_label = |scene: &Recorded| scene.items.iter().any(|object| object.label().is_some());
    recorder.wait_for("something is named", |scenes| scenes.iter().any(has_label));
    let (scenes, _) = recorder.stop();
    daemon.stop();
    let first = scenes.iter().find(|scene| has_label(scene)).unwrap();
    (first.header.stamps.published_ns - began_ns) as f64 * 1e-6
}

/// Centroids of the labelled objects that are large enough, camera frame.
fn labelled_objects(folder: &SceneFolder, scene: usize) -> Vec<Point3<f64>> {
    let bytes =
        std::fs::read(real_data::folder("tabletop-scenes").join(folder.name(scene).unwrap()));
    let cloud = pcd::read(&bytes.unwrap()).unwrap();
    let mut sums = BTreeMap::<u32, (Vector3<f64>, usize)>::new();
    for (point, label) in cloud.points.iter().zip(cloud.labels.unwrap()) {
        // Below 20 lie the table and its parts; the last digit is the object's part.
        if label >= 20 && point.is_finite() {
            let sum = sums.entry(label / 10).or_default();
            sum.0 += point.position().coords;
            sum.1 += 1;
        }
    }
    let large = sums.into_values().filter(|(_, n)| *n >= MIN_PIXELS);
    large.map(|(sum, n)| Point3::from(sum / n as f64)).collect()
}

fn box_of(object: &SceneObject) -> OrientedBox {
    let [x, y, z, w] = object.pose.orientation_xyzw;
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    let translation = Translation3::from(object.pose.position_m);
    OrientedBox {
        frame_from_box: RigidTransform::from_parts(translation, rotation),
        half_sides_m: Vector3::from(object.size_m.map(|side| 0.5 * f64::from(side))),
    }
}

/// The tracks of a scene's only frame.
fn tracks(folder: &str, scene: usize) -> Vec<OrientedBox> {
    let place = Place::new();
    let recorder = SceneRecorder::start(&place);
    let (from, to) = (scene.to_string(), (scene + 1).to_string());
    let daemon = place.start(&[
        "--source",
        folder,
        "--from",
        &from,
        "--to",
        &to,
        "--lockstep",
    ]);
    recorder.wait_for("the scene", |scenes| !scenes.is_empty());
    let (scenes, _) = recorder.stop();
    daemon.stop();
    let seen = [TrackState::Tentative, TrackState::Tracked].map(TrackState::code);
    let is_seen = |object: &&SceneObject| seen.contains(&object.state);
    scenes[0].items.iter().filter(is_seen).map(box_of).collect()
}

/// Tracks, labelled objects, and labelled objects whose centroid lies in a
/// track's box, for every scene.
fn measure_found() {
    let folder = SceneFolder::open(&real_data::folder("tabletop-scenes")).unwrap();
    let source = source("tabletop-scenes");
    let (mut n_tracks, mut n_objects, mut n_found, mut n_equal) = (0, 0, 0, 0);
    println!("objects found in each scene: tracks / labelled objects (found)");
    for scene in 0..folder.len() {
        let boxes = tracks(&source, scene);
        let labelled = labelled_objects(&folder, scene);
        let is_found =
            |centroid: &&Point3<f64>| boxes.iter().any(|b| b.contains(centroid, BOX_MARGIN_M));
        let found = labelled.iter().filter(is_found).count();
        let name = folder.name(scene).unwrap();
        println!(
            "    {name:14} {:2} / {:2} ({found})",
            boxes.len(),
            labelled.len()
        );
        n_tracks += boxes.len();
        n_objects += labelled.len();
        n_found += found;
        n_equal += usize::from(boxes.len() == labelled.len());
    }
    let n_scenes = folder.len();
    println!("    all: {n_tracks} tracks, {n_found} of {n_objects} objects found");
    println!("    {n_equal} of {n_scenes} scenes with as many tracks as objects");
    assert!(n_objects > 0 && n_found > 0);
}

#[test]
#[ignore = "long"]
fn long_figures() {
    let place = Place::new();
    teach_something(&place);
    let mut starts: Vec<f64> = (0..N_COLD_STARTS).map(|_| cold_start_ms(&place)).collect();
    starts.sort_by(f64::total_cmp);
    println!("cold start to the first label, ms: {starts:.0?}");
    measure_latency(&place, "tabletop-scenes", true);
    measure_latency(&place, "kitchen-sequence", false);
    measure_found();
}
