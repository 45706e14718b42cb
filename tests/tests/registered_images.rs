//! Registered colour and depth images of any size, without poses, as a source.

use crate::daemon::{Daemon, Sandbox, eventually, nearest};
use camera::synthetic::SyntheticTable;
use dataset::rgbd_sequence::{FrameView, SequenceWriter};
use geometry::PinholeCamera;
use message::ProcessKind;
use serde_json::Value;
use std::path::Path;

/// Largest distance of an object from its true position, metres: the camera sees one side.
const DISTANCE_MAX_M: f64 = 0.06;
/// Number of frames of a written folder.
const N_FRAMES: usize = 3;

/// Camera of this size and focal length, pixels, with square pixels and a centred image.
fn camera(width: u32, height: u32, focal_px: f64) -> PinholeCamera {
    PinholeCamera {
        fx_px: focal_px,
        fy_px: focal_px,
        cx_px: f64::from(width - 1) / 2.0,
        cy_px: f64::from(height - 1) / 2.0,
        width,
        height,
    }
}

/// Writes frames of a table without poses, with intrinsics in JSON; depth in units of a half
/// millimetre.
fn write_images(folder: &Path, table: &SyntheticTable, camera: &PinholeCamera) {
    let view = table.render(camera, &table.world_from_camera());
    let unit = |z_m: &f32| {
        if z_m.is_finite() {
            (2000.0 * z_m).round() as u16
        } else {
            0
        }
    };
    let depth: Vec<u16> = view.depth_m.iter().map(unit).collect();
    let mut writer = SequenceWriter::create(folder, camera, None).unwrap();
    let frame = FrameView {
        color: &view.rgb,
        depth_mm: &depth,
        instances: None,
        world_from_camera: None,
        truth: None,
    };
    for _ in 0..N_FRAMES {
        writer.write(&frame).unwrap();
    }
    std::fs::remove_file(folder.join("camera-intrinsics.txt")).unwrap();
    let json = serde_json::json!({
        "width": camera.width, "height": camera.height, "fx": camera.fx_px, "fy": camera.fy_px,
        "cx": camera.cx_px, "cy": camera.cy_px, "depth_scale": 0.5,
    });
    std::fs::write(folder.join("camera.json"), json.to_string()).unwrap();
}

/// Positions of a table's objects in the camera frame, metres.
fn places_in_camera(table: &SyntheticTable) -> Vec<[f64; 3]> {
    let camera_from_world = table.world_from_camera().inverse();
    let objects = table.objects().iter();
    objects
        .map(|object| (camera_from_world * object.centre_in_world()).coords.into())
        .collect()
}

fn distance_m(object: &Value, place: [f64; 3]) -> f64 {
    let axis = |i: usize| object["position_m"][i].as_f64().unwrap() - place[i];
    (0..3).map(|i| axis(i) * axis(i)).sum::<f64>().sqrt()
}

fn is_tracked_at(objects: &[Value], place: [f64; 3]) -> bool {
    !objects.is_empty() && {
        let object = nearest(objects, place);
        object["state"] == "tracked" && distance_m(object, place) < DISTANCE_MAX_M
    }
}

fn count(daemon: &Daemon<'_>, process: ProcessKind, what: &str) -> u64 {
    let health = daemon.health(process.word());
    health.and_then(|health| health[what].as_u64()).unwrap_or(0)
}

/// Asserts that the objects of the synthetic table are tracked in images of a camera.
fn check_size(camera: &PinholeCamera) {
    let (sandbox, table) = (Sandbox::new(), SyntheticTable::new(0));
    let folder = tempfile::tempdir().unwrap();
    write_images(folder.path(), &table, camera);
    let source = folder.path().to_str().unwrap();
    let daemon = sandbox.start(&["--source", source, "--loop", "--rate", "5"]);
    let places = places_in_camera(&table);
    daemon.wait_for("all objects are tracked", |objects| {
        places.iter().all(|place| is_tracked_at(objects, *place))
    });
    eventually("the folder is played twice", || {
        count(&daemon, ProcessKind::CAMERA, "frames") > 2 * N_FRAMES as u64
    });
    assert_eq!(count(&daemon, ProcessKind::CAMERA, "frames_dropped"), 0);
    daemon.stop();
    assert_eq!(sandbox.shared_memory_files(), Vec::<String>::new());
}

#[test]
fn registered_images_smaller_than_a_kinects_are_played() {
    check_size(&camera(424, 240, 300.0));
}

#[test]
fn registered_images_larger_than_a_kinects_are_played() {
    check_size(&camera(1280, 720, 900.0));
}

#[test]
fn unusable_registered_images_are_skipped_and_counted() {
    let (sandbox, table) = (Sandbox::new(), SyntheticTable::new(0));
    let folder = tempfile::tempdir().unwrap();
    write_images(folder.path(), &table, &camera(320, 240, 290.0));
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("frame-000001.depth.png"), "no image").unwrap();
    std::fs::copy(
        path("frame-000000.depth.png"),
        path("frame-000002.color.png"),
    )
    .unwrap();
    let source = folder.path().to_str().unwrap();
    let daemon = sandbox.start(&["--source", source, "--lockstep"]);
    eventually("the recording ends", || {
        let health = daemon.health(ProcessKind::CAMERA.word());
        health.is_some_and(|health| health["state"] == "idle")
    });
    assert_eq!(count(&daemon, ProcessKind::CAMERA, "frames"), 1);
    assert_eq!(count(&daemon, ProcessKind::CAMERA, "frames_dropped"), 2);
    let log = daemon.log();
    for name in ["frame-000001.depth.png", "frame-000002.color.png"] {
        let reported = log.lines().find(|line| line.contains(name)).unwrap();
        assert!(
            reported.contains("is left out") && reported.contains("replace it"),
            "{reported}"
        );
    }
    daemon.stop();
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn registered_images_of_another_camera_are_played_to_their_end() {
    let sandbox = Sandbox::new();
    let folder = test_data::path("other-camera");
    let source = folder.to_str().unwrap();
    let daemon = sandbox.start(&["--source", source, "--lockstep"]);
    eventually("the recording ends", || {
        let health = daemon.health(ProcessKind::CAMERA.word());
        health.is_some_and(|health| health["state"] == "idle")
    });
    for process in [ProcessKind::CAMERA, ProcessKind::PERCEPTION] {
        // Processes report one after the other.
        eventually("all frames are reported", || {
            count(&daemon, process, "frames") == 5
        });
        assert_eq!(
            count(&daemon, process, "frames_dropped"),
            0,
            "{}",
            process.word()
        );
    }
    daemon.stop();
    // Each scene shows at least three things on a table. One picture is no proof of an object.
    let daemon = sandbox.start(&["--source", source, "--to", "1", "--loop"]);
    daemon.wait_for("objects of the first scene", |objects| objects.len() >= 3);
    daemon.stop();
}
