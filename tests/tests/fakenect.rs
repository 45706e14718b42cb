//! Fakenect: a recording of the synthetic scene, played through the real libfreenect.

use crate::daemon::{Daemon, Sandbox, eventually, nearest};
use camera::synthetic::{RenderedView, SyntheticTable};
use dataset::fakenect_folder::FakenectWriter;
use freenect::{Calibration, DepthTable};
use geometry::RigidTransform;
use message::ProcessKind;
use nalgebra::Point3;
use serde_json::Value;
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;

/// Number of frames of the recording: two seconds.
const N_FRAMES: u32 = 60;
/// Frame period in ticks of the Kinect's clock, and in wall-clock time.
const TICKS_PER_FRAME: u32 = freenect::CLOCK_HZ / 30;
const FRAME_TIME: Duration = Duration::from_nanos(33_333_333);
/// Wall-clock time at the start of the recording.
const BEGAN: Duration = Duration::from_secs(1_300_000_000);
/// Tolerance of positions, metres: the box of the visible points differs from that of the
/// object, whose back is hidden.
const POSITION_TOLERANCE_M: f64 = 0.015;
/// Tolerance of mean colours, 0 to 255: at edges the colour camera sees another surface.
const COLOUR_TOLERANCE: f64 = 20.0;

/// Synthetic table seen by a Kinect with the nominal calibration.
pub(crate) struct KinectScene {
    table: SyntheticTable,
    pub(crate) calibration: Calibration,
}

impl KinectScene {
    pub(crate) fn new(arrangement: u32) -> Self {
        Self {
            table: SyntheticTable::new(arrangement),
            calibration: Calibration::nominal(),
        }
    }

    fn world_from_depth(&self) -> RigidTransform {
        self.table.world_from_camera()
    }

    fn depth(&self) -> RenderedView {
        self.table
            .render(&self.calibration.depth_camera, &self.world_from_depth())
    }

    pub(crate) fn color(&self) -> RenderedView {
        let world_from_color =
            self.world_from_depth() * self.calibration.color_from_depth.inverse();
        self.table
            .render(&self.calibration.color_camera, &world_from_color)
    }

    /// Writes the scene as a fakenect recording.
    fn record(&self, folder: &Path) {
        let table = DepthTable::new(self.calibration.formula);
        let raw: Vec<u16> = self
            .depth()
            .depth_m
            .iter()
            .map(|&depth| table.raw(depth))
            .collect();
        let rgb = self.color().rgb;
        let mut writer = FakenectWriter::create(folder).unwrap();
        for n in 0..N_FRAMES {
            let (time, stamp) = (BEGAN + n * FRAME_TIME, n * TICKS_PER_FRAME);
            writer.write_depth(&raw, time, stamp).unwrap();
            let later = TICKS_PER_FRAME / 10;
            writer
                .write_color(&rgb, time + FRAME_TIME / 10, stamp + later)
                .unwrap();
        }
    }

    /// Ground-truth positions (camera frame, metres) and mean colours (0 to 255).
    fn truth(&self) -> Vec<(&'static str, [f64; 3], [f64; 3])> {
        let depth_from_world = self.world_from_depth().inverse();
        let view = self.depth();
        let objects = self.table.objects().iter();
        let position = |centre: &Point3<f64>| (depth_from_world * centre).coords.into();
        objects
            .map(|object| {
                let color =
                    self.mean_color(&view, |point| object.bounds_in_world.contains(point, 0.0));
                (object.name, position(&object.centre_in_world()), color)
            })
            .collect()
    }

    /// Mean colour of the visible points that fulfil a predicate, world frame.
    fn mean_color(&self, view: &RenderedView, is_meant: impl Fn(&Point3<f64>) -> bool) -> [f64; 3] {
        let camera = &self.calibration.depth_camera;
        let width = camera.width as usize;
        let (mut sum, mut n) = ([0.0; 3], 0.0);
        for (i, depth) in view
            .depth_m
            .iter()
            .enumerate()
            .filter(|(_, depth)| depth.is_finite())
        {
            let (column, row) = ((i % width) as f64, (i / width) as f64);
            let point = camera.back_project(column, row, f64::from(*depth));
            if is_meant(&(self.world_from_depth() * point)) {
                n += 1.0;
                for (sum, value) in sum.iter_mut().zip(&view.rgb[3 * i..]) {
                    *sum += f64::from(*value);
                }
            }
        }
        assert!(n > 100.0, "only {n} points are seen");
        sum.map(|sum| sum / n)
    }
}

/// Folder with a recording of an arrangement.
pub(crate) fn recording(scene: &KinectScene) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    scene.record(folder.path());
    folder
}

pub(crate) fn source(folder: &TempDir) -> String {
    format!("fakenect:{}", folder.path().display())
}

fn tracked(objects: &[Value]) -> usize {
    objects
        .iter()
        .filter(|object| object["state"] == "tracked")
        .count()
}

fn numbers(value: &Value) -> [f64; 3] {
    let values = value.as_array().unwrap();
    [0, 1, 2].map(|i| values[i].as_f64().unwrap())
}

fn largest_difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

fn camera(daemon: &Daemon<'_>, key: &str) -> Value {
    daemon
        .health(ProcessKind::CAMERA.word())
        .unwrap_or_default()[key]
        .clone()
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn fakenect_objects_are_tracked_at_their_positions_in_their_colours() {
    let scene = KinectScene::new(0);
    let folder = recording(&scene);
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", &source(&folder), "--loop"]);
    let truth = scene.truth();
    let objects = daemon.wait_for("all objects are tracked", |objects| {
        tracked(objects) == truth.len() && objects.len() == truth.len()
    });
    let all = daemon.ask(&["objects"]);
    assert_eq!(all["has_world_pose"], false, "world is the camera's frame");
    for (name, position, color) in truth {
        let object = nearest(&objects, position);
        let (found, found_color) = (numbers(&object["position_m"]), numbers(&object["mean_rgb"]));
        println!(
            "{name}: at {position:.3?}, found {found:.3?}; {color:.0?}, found {found_color:?}"
        );
        assert!(
            largest_difference(position, found) < POSITION_TOLERANCE_M,
            "{name}: {object:#}"
        );
        assert!(
            largest_difference(color, found_color) < COLOUR_TOLERANCE,
            "{name}: {object:#}"
        );
    }
    daemon.stop();
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn fakenect_camera_is_idle_after_the_end_of_the_recording() {
    let folder = recording(&KinectScene::new(1));
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", &source(&folder)]);
    eventually("the recording ends", || camera(&daemon, "state") == "idle");
    let n_frames = camera(&daemon, "frames").as_u64().unwrap();
    // Fakenect drops images that are not taken in time, and the incomplete pair at the end.
    assert!(
        (1..=u64::from(N_FRAMES)).contains(&n_frames),
        "{}",
        daemon.log()
    );
    daemon.stop();
}

#[test]
#[ignore = "needs libfreenect0.5"]
fn fakenect_loop_restarts_the_process_and_continues() {
    let folder = recording(&KinectScene::new(1));
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", &source(&folder), "--loop"]);
    let n_starts = || daemon.log().matches("playing fakenect").count();
    eventually("the recording has begun three times", || n_starts() >= 3);
    let frames = || daemon.health(ProcessKind::PERCEPTION.word()).unwrap()["frames"].as_u64();
    let before = frames().unwrap();
    eventually("frames come after that", || frames() > Some(before + 10));
    assert_ne!(camera(&daemon, "state"), "idle");
    let restarted = daemon.log().contains("starting it again");
    assert!(
        !restarted,
        "the process restarts itself and is not restarted:\n{}",
        daemon.log()
    );
    daemon.stop();
}
