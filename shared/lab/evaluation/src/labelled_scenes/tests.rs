use super::*;
use dataset::pcd::{Encoding, PcdView};
use dataset::rgbd_sequence::{FrameView, SequenceWriter};
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::UnitQuaternion;
use std::f64::consts::FRAC_PI_2;

const CAMERA: PinholeCamera = PinholeCamera {
    fx_px: 4.0,
    fy_px: 4.0,
    cx_px: 1.5,
    cy_px: 0.5,
    width: 4,
    height: 2,
};

fn write_pcd(path: &Path, labels: Option<&[u32]>) {
    let points = [Point::default(); 6];
    let view = PcdView {
        points: &points,
        labels,
        width: 3,
        height: 2,
        viewpoint: RigidTransform::identity(),
    };
    std::fs::write(path, pcd::write(view, Encoding::Binary).unwrap()).unwrap();
}

/// Sequence with one frame per instance mask.
fn write_sequence(folder: &Path, masks: &[Option<[u16; 8]>]) {
    let down = Some(-Vector3::z_axis());
    let mut writer = SequenceWriter::create(folder, &CAMERA, down).unwrap();
    // The camera looks along world y.
    let mut world_from_camera = RigidTransform::identity();
    world_from_camera.rotation = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -FRAC_PI_2);
    for mask in masks {
        let frame = FrameView {
            color: &[90; 24],
            depth_mm: &[0, 1000, 1000, 1000, 1000, 1000, 1000, 1000],
            instances: mask.as_ref().map(<[u16; 8]>::as_slice),
            world_from_camera: Some(world_from_camera),
            truth: None,
        };
        writer.write(&frame).unwrap();
    }
}

fn names(scenes: &LabelledScenes) -> Vec<(&str, &str, bool)> {
    let entries = scenes.entries().iter();
    entries
        .map(|entry| (entry.name.as_str(), entry.group.as_str(), entry.is_odd))
        .collect()
}

#[test]
fn pcd_scenes_come_in_natural_order_with_their_labels() {
    let folder = tempfile::tempdir().unwrap();
    let labels = [0, 1, 9, 20, 31, 65535];
    for name in ["learn20.pcd", "learn3.pcd"] {
        write_pcd(&folder.path().join(name), Some(&labels));
    }
    let scenes = LabelledScenes::open(folder.path()).unwrap();
    assert_eq!(
        names(&scenes),
        [("learn3", "boxes", true), ("learn20", "stacked", false)]
    );
    let scene = scenes.read(&scenes.entries()[0]).unwrap();
    assert_eq!(scene.labels, labels.map(|label| label as u16));
    assert_eq!((scene.width, scene.height, scene.points.len()), (3, 2, 6));
    assert_eq!(scene.up_in_camera, None);
}

#[test]
fn masks_become_labels_and_gravity_up() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pile");
    write_sequence(&path, &[Some([3, 3, 0, 1, 65535, 65534, 60, 0]), None]);
    let scenes = LabelledScenes::open(&path).unwrap();
    assert_eq!(names(&scenes)[0], ("pile-frame-000000", "pile", false));
    assert_eq!(names(&scenes)[1], ("pile-frame-000001", "pile", true));
    let scene = scenes.read(&scenes.entries()[0]).unwrap();
    assert_eq!(scene.labels, [0, 30, 1, 10, 1, 1, 600, 1]);
    // Up in the image of a camera that looks along the horizon.
    let up = scene.up_in_camera.unwrap();
    assert!((up.into_inner() + Vector3::y()).norm() < 1e-9, "{up:?}");
    let error = scenes.read(&scenes.entries()[1]).unwrap_err();
    assert!(matches!(error, Error::NoMask), "{error}");
}

#[test]
fn sub_folders_are_groups_and_unusable_ones_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    write_sequence(&path("pile"), &[Some([0; 8])]);
    for name in ["kitchen", "notes"] {
        std::fs::create_dir(path(name)).unwrap();
    }
    write_pcd(&path("kitchen/table.pcd"), Some(&[0; 6]));
    std::fs::write(path("notes/a.txt"), "a").unwrap();
    std::fs::write(path("readme.txt"), "a").unwrap();
    let scenes = LabelledScenes::open(folder.path()).unwrap();
    assert_eq!(
        names(&scenes),
        [
            ("kitchen-table", "kitchen", false),
            ("pile-frame-000000", "pile", false)
        ]
    );
    let [(name, error)] = scenes.unusable() else {
        panic!("{:?}", scenes.unusable())
    };
    assert!(name == "notes" && error.to_string().contains("holds no recording"));
}

#[test]
fn unusable_folders_are_refused_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in [
        "nothing",
        "text",
        "fakenect",
        "pcd",
        "twice",
        "twice/a",
        "twice/a-b",
    ] {
        std::fs::create_dir(path(name)).unwrap();
    }
    std::fs::write(path("text/a.txt"), "a").unwrap();
    std::fs::write(path("fakenect/INDEX.txt"), "a").unwrap();
    write_pcd(&path("twice/a/b-c.pcd"), None);
    write_pcd(&path("twice/a-b/c.pcd"), None);
    for (name, reason) in [
        ("missing", "could not"),
        ("nothing", "is empty"),
        ("text", "holds no recording"),
        ("fakenect", "no truth"),
        ("twice", "two scenes are called a-b-c"),
    ] {
        let error = LabelledScenes::open(&path(name)).unwrap_err().to_string();
        assert!(error.contains(reason), "{name}: {error}");
    }
    write_pcd(&path("pcd/a.pcd"), None);
    write_pcd(&path("pcd/b.pcd"), Some(&[70_000; 6]));
    std::fs::write(path("pcd/c.pcd"), "no cloud").unwrap();
    let scenes = LabelledScenes::open(&path("pcd")).unwrap();
    for (entry, reason) in scenes
        .entries()
        .iter()
        .zip(["no field `label`", "70000", "PCD"])
    {
        let error = scenes.read(entry).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
    }
}
