use super::*;
use crate::pcd::{self, Encoding, PcdView};
use crate::washington::{CAMERA, CroppedView, ViewName, write_view};
use geometry::RigidTransform;
use mutation_fuzzing::assert_sentence;
use nalgebra::{UnitQuaternion, Vector3};
use point_cloud::Point;
use std::fs;

const POINTS: [Point; 2] = [
    Point {
        x: 0.1,
        y: 0.2,
        z: 0.3,
        color: point_cloud::Rgba::opaque(1, 2, 3),
    },
    Point {
        x: f32::NAN,
        y: 0.0,
        z: 0.0,
        color: point_cloud::Rgba::opaque(4, 5, 6),
    },
];

fn pcd_bytes(points: &[Point], viewpoint: RigidTransform) -> Vec<u8> {
    let view = PcdView {
        points,
        labels: None,
        width: points.len(),
        height: 1,
        viewpoint,
    };
    pcd::write(view, Encoding::Binary).unwrap()
}

fn write_pcd(root: &Path, path: &str, viewpoint: RigidTransform) {
    let path = root.join(path);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, pcd_bytes(&POINTS, viewpoint)).unwrap();
}

/// View of one pixel at 1 m.
fn one_pixel() -> CroppedView {
    CroppedView {
        size: (1, 1),
        top_left: (100, 50),
        color: vec![10, 20, 30],
        depth_mm: vec![1000],
        mask: vec![255],
    }
}

#[test]
fn folder_names_are_categories() {
    let root = tempfile::tempdir().unwrap();
    let elsewhere = RigidTransform::from_parts(
        Vector3::new(1.0, 2.0, 3.0).into(),
        UnitQuaternion::identity(),
    );
    write_pcd(root.path(), "mug/mug_10.pcd", RigidTransform::identity());
    write_pcd(root.path(), "mug/mug_2.pcd", elsewhere);
    write_pcd(root.path(), "bowl/a.pcd", RigidTransform::identity());
    fs::create_dir(root.path().join("empty")).unwrap();
    fs::write(root.path().join("notes.pcd"), "not in a folder").unwrap();
    let views = ObjectViews::open(root.path()).unwrap();
    let listed: Vec<_> = views
        .files()
        .iter()
        .map(|file| (file.category.as_str(), file.path.to_str().unwrap()))
        .collect();
    assert_eq!(
        listed,
        [
            ("bowl", "bowl/a.pcd"),
            ("mug", "mug/mug_2.pcd"),
            ("mug", "mug/mug_10.pcd")
        ]
    );
    assert!(views.files().iter().all(|file| file.instance.is_none()));
    assert!(views.unusable().is_empty());
    let (unknown, known) = (views.load(0).unwrap(), views.load(1).unwrap());
    assert_eq!((unknown.points.len(), unknown.viewpoint_m), (1, None));
    assert_eq!(known.viewpoint_m, Some([1.0, 2.0, 3.0].into()));
    assert_eq!((unknown.up, known.up), (None, None));
}

#[test]
fn washington_views_know_their_camera() {
    let root = tempfile::tempdir().unwrap();
    for (instance, sequence, camera) in [(1, 1, Some(&CAMERA)), (2, 4, None), (2, 7, None)] {
        let name = ViewName::new("cell_phone", instance, sequence, 1).unwrap();
        write_view(root.path(), &name, &one_pixel(), camera).unwrap();
    }
    let views = ObjectViews::open(root.path()).unwrap();
    let listed: Vec<_> = views
        .files()
        .iter()
        .map(|file| {
            (
                file.instance.as_deref().unwrap(),
                file.path.to_str().unwrap(),
            )
        })
        .collect();
    assert_eq!(
        listed,
        [
            ("1", "cell_phone/cell_phone_1/cell_phone_1_1_1.pcd"),
            ("2", "cell_phone/cell_phone_2/cell_phone_2_4_1_crop.png"),
            ("2", "cell_phone/cell_phone_2/cell_phone_2_7_1_crop.png")
        ]
    );
    let loaded: Vec<_> = (0..3).map(|index| views.load(index).unwrap()).collect();
    // The same pixel through the PCD file and through the images.
    for view in &loaded {
        let (point, expected) = (view.points[0], loaded[1].points[0]);
        assert!((point.position() - expected.position()).norm() < 1e-6);
        assert_eq!(view.viewpoint_m, Some(nalgebra::Point3::origin()));
    }
    // A camera that looks down by 30 degrees has up half against its axis.
    assert!((loaded[0].up.unwrap().z + 0.5).abs() < 1e-12);
    assert!((loaded[1].up.unwrap().y + 0.5).abs() < 1e-12);
    assert_eq!(loaded[2].up, None);
}

#[test]
fn unreadable_views_are_reported_with_their_file() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("mug");
    fs::create_dir(&folder).unwrap();
    let whole = pcd_bytes(&POINTS, RigidTransform::identity());
    fs::write(folder.join("1-cut.pcd"), &whole[..whole.len() - 3]).unwrap();
    fs::write(folder.join("2-empty.pcd"), []).unwrap();
    fs::create_dir(folder.join("3-folder.pcd")).unwrap();
    let holes = pcd_bytes(&POINTS[1..], RigidTransform::identity());
    fs::write(folder.join("4-holes.pcd"), holes).unwrap();
    fs::write(folder.join("5-good.pcd"), &whole).unwrap();
    let views = ObjectViews::open(root.path()).unwrap();
    assert_eq!(views.files().len(), 5);
    for (index, name) in ["1-cut", "2-empty", "3-folder", "4-holes"]
        .iter()
        .enumerate()
    {
        let error = views.load(index).unwrap_err();
        assert_sentence(&error);
        assert!(error.to_string().contains(name), "{error}");
    }
    assert_eq!(views.load(4).unwrap().points.len(), 1);
    assert_sentence(&views.load(5).unwrap_err());
}

#[test]
fn a_folder_without_views_is_named() {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir(root.path().join("mug")).unwrap();
    for path in [root.path().to_owned(), root.path().join("missing")] {
        let error = ObjectViews::open(&path).unwrap_err();
        assert_sentence(&error);
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(error.to_string().contains(name), "{error}");
    }
}
