//! Format readers on real files. Facts about the files are from the data's own description;
//! ranges are wide enough for any correct reader and too narrow for swapped fields, byte orders
//! or units.

use dataset::{
    RecordingKind, detect_recording_kind, model_folder, pcd, ply, registered_images, rgbd_sequence,
    scene_folder,
};
use point_cloud::Point;
use std::collections::BTreeSet;

#[test]
#[ignore = "needs TABULA_DATA"]
fn tabletop_scenes_are_all_read() {
    let folder = test_data::path("tabletop-scenes");
    assert_eq!(
        detect_recording_kind(&folder).unwrap(),
        RecordingKind::PcdScenes
    );
    let scenes = scene_folder::SceneFolder::open(&folder).unwrap();
    assert_eq!(scenes.len(), 45);
    let (mut bytes, mut decoder) = (Vec::new(), pcd::Decoder::new());
    let mut points = vec![Point::default(); 640 * 480];
    let mut labels = vec![0; 640 * 480];
    for index in 0..scenes.len() {
        assert_eq!(
            scenes.name(index),
            Some(format!("learn{index}.pcd").as_str())
        );
        scenes.read_bytes(index, &mut bytes).unwrap();
        let header = pcd::Header::parse(&bytes).unwrap();
        assert_eq!((header.width(), header.height()), (640, 480));
        decoder
            .decode_into(&bytes, &header, &mut points, Some(&mut labels))
            .unwrap();
        check_scene(index, &points, &labels);
    }
}

fn check_scene(index: usize, points: &[Point], labels: &[u32]) {
    let measured: Vec<&Point> = points.iter().filter(|point| point.is_finite()).collect();
    let share = measured.len() as f64 / points.len() as f64;
    assert!((0.3..0.95).contains(&share), "scene {index}: {share}");
    assert!(
        measured
            .iter()
            .all(|p| (0.3..10.0).contains(&p.z) && p.x.abs() < 5.0 && p.y.abs() < 5.0)
    );
    // The camera looks at the table: x grows to the right, y downwards.
    for pixel in [100 * 640 + 20, 240 * 640 + 320, 470 * 640 + 600] {
        let point = points[pixel];
        let (right, down) = ((pixel % 640) as f32 - 319.5, (pixel / 640) as f32 - 239.5);
        if point.is_finite() {
            let (x, y) = (525.0 * point.x / point.z, 525.0 * point.y / point.z);
            assert!(
                (x - right).abs() < 12.0 && (y - down).abs() < 12.0,
                "scene {index}: {x} {y}"
            );
        }
    }
    let kinds: BTreeSet<u32> = labels.iter().map(|label| label / 10 * 10).collect();
    assert!(
        kinds.len() > 2 && kinds.last().is_some_and(|kind| *kind < 300),
        "scene {index}: {kinds:?}"
    );
    let labelled = points.iter().zip(labels).filter(|(_, label)| **label != 0);
    let n_labelled_measured = labelled
        .clone()
        .filter(|(point, _)| point.is_finite())
        .count();
    assert_eq!(labelled.count(), n_labelled_measured, "scene {index}");
    let colors: BTreeSet<[u8; 3]> = points.iter().map(|point| point.color.rgb()).collect();
    assert!(
        colors.len() > 1000,
        "scene {index}: {} colours",
        colors.len()
    );
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn pcd_scene_survives_each_encoding() {
    let scene = pcd::open(&test_data::path("tabletop-scenes").join("learn33.pcd")).unwrap();
    let bits = |cloud: &pcd::PcdCloud| -> Vec<[u32; 4]> {
        let bits = |p: &Point| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), p.color.0];
        cloud.points.iter().map(bits).collect()
    };
    for encoding in [
        pcd::Encoding::Ascii,
        pcd::Encoding::Binary,
        pcd::Encoding::BinaryCompressed,
    ] {
        let again = pcd::read(&pcd::write(scene.view(), encoding).unwrap()).unwrap();
        assert!(
            bits(&again) == bits(&scene) && again.labels == scene.labels,
            "{encoding:?}"
        );
    }
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn restaurant_views_are_all_read() {
    let mut n_views = 0;
    for category in test_data::path("restaurant-views").read_dir().unwrap() {
        let views = scene_folder::SceneFolder::open(&category.unwrap().path()).unwrap();
        let mut bytes = Vec::new();
        for index in 0..views.len() {
            views.read_bytes(index, &mut bytes).unwrap();
            let view = pcd::read(&bytes).unwrap();
            assert!(view.points.len() > 50 && view.height == 1 && view.labels.is_none());
            assert!(
                view.points
                    .iter()
                    .all(|p| p.is_finite() && p.position().coords.norm() < 0.5)
            );
            n_views += 1;
        }
    }
    assert_eq!(n_views, 20 * 60);
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn household_models_are_all_read() {
    let mut n_models = 0;
    for entry in test_data::path("household-models").read_dir().unwrap() {
        let path = entry.unwrap().path();
        let mesh = ply::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(
            (6_000..8_000).contains(&mesh.vertices.len()),
            "{}",
            path.display()
        );
        assert!(
            (12_000..15_000).contains(&mesh.triangles.len()),
            "{}",
            path.display()
        );
        let positions = || mesh.vertices.iter().map(|vertex| vertex.position().coords);
        let low = positions()
            .reduce(|low, position| low.inf(&position))
            .unwrap();
        let high = positions()
            .reduce(|high, position| high.sup(&position))
            .unwrap();
        let longest_m = (high - low).amax();
        assert!(
            (0.02..0.5).contains(&longest_m),
            "{}: {longest_m} m",
            path.display()
        );
        let colors: BTreeSet<[u8; 3]> = mesh.vertices.iter().map(|v| v.color.rgb()).collect();
        assert!(
            colors.len() > 50,
            "{}: {} colours",
            path.display(),
            colors.len()
        );
        for encoding in [ply::Encoding::Ascii, ply::Encoding::BinaryBigEndian] {
            assert!(ply::read(&ply::write(mesh.view(), encoding).unwrap()).unwrap() == mesh);
        }
        n_models += 1;
    }
    assert_eq!(n_models, 51);
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn kitchen_sequence_is_read() {
    let folder = test_data::path("kitchen-sequence");
    assert_eq!(
        detect_recording_kind(&folder).unwrap(),
        RecordingKind::RgbdSequence
    );
    let sequence = rgbd_sequence::RgbdSequence::open(&folder).unwrap();
    assert_eq!(sequence.n_frames(), 500);
    let camera = *sequence.camera();
    assert_eq!(
        (camera.width, camera.height, camera.fx_px, camera.cx_px),
        (640, 480, 585.0, 320.0)
    );
    let gravity_in_world = sequence.gravity_in_world().unwrap();
    let mut scratch = rgbd_sequence::Scratch::default();
    let mut points = vec![Point::default(); camera.n_pixels()];
    let mut last_position = None;
    for index in 0..sequence.n_frames() {
        assert_eq!(
            sequence.name(index),
            Some(format!("frame-{index:06}").as_str())
        );
        let world_from_camera = sequence
            .fill(index, &mut scratch, &mut points)
            .unwrap()
            .unwrap();
        let n_measured = points.iter().filter(|point| point.is_finite()).count();
        assert!(
            (150_000..307_200).contains(&n_measured),
            "frame {index}: {n_measured}"
        );
        assert!(
            points
                .iter()
                .all(|p| p.z.is_nan() || (0.3..11.0).contains(&p.z)),
            "frame {index}"
        );
        if index % 50 == 0 {
            let colors: BTreeSet<[u8; 3]> = points.iter().map(|point| point.color.rgb()).collect();
            assert!(
                colors.len() > 5_000,
                "frame {index}: {} colours",
                colors.len()
            );
        }
        let down_in_camera = world_from_camera.rotation.inverse() * gravity_in_world;
        assert!(down_in_camera.y > 0.7, "frame {index}: {down_in_camera:?}");
        // A hand moves less than 10 cm between two frames.
        let position = world_from_camera.translation.vector;
        let step_m = last_position
            .replace(position)
            .map_or(0.0, |last| (position - last).norm());
        assert!(step_m < 0.1, "frame {index}: {step_m} m");
    }
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn images_of_another_camera_are_read() {
    let folder = test_data::path("other-camera");
    assert_eq!(
        detect_recording_kind(&folder).unwrap(),
        RecordingKind::RegisteredImages
    );
    let images = registered_images::RegisteredImages::open(&folder).unwrap();
    let names: Vec<_> = (0..images.n_frames())
        .map(|i| images.name(i).unwrap())
        .collect();
    assert_eq!(names, ["000000", "000002", "000004", "000006", "000008"]);
    let camera = *images.camera();
    assert_eq!((camera.width, camera.height), (640, 480));
    assert_eq!(
        [camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px],
        [612.937, 613.173, 322.549, 248.158]
    );
    let mut points = vec![Point::default(); camera.n_pixels()];
    for index in 0..images.n_frames() {
        let mut scratch = registered_images::Scratch::default();
        images.fill(index, &mut scratch, &mut points).unwrap();
        let measured: Vec<&Point> = points.iter().filter(|point| point.is_finite()).collect();
        let share = measured.len() as f64 / points.len() as f64;
        assert!(share > 0.5, "frame {index}: {share}");
        // A table-top scene: half of what is seen is within arm's reach.
        let n_near = measured.iter().filter(|p| (0.3..2.0).contains(&p.z));
        assert!(2 * n_near.count() > measured.len(), "frame {index}");
        let colors: BTreeSet<[u8; 3]> = points.iter().map(|point| point.color.rgb()).collect();
        assert!(
            colors.len() > 5_000,
            "frame {index}: {} colours",
            colors.len()
        );
    }
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn household_models_are_listed_with_number_and_name() {
    let models = model_folder::list(&test_data::path("household-models")).unwrap();
    assert_eq!(models.len(), 51);
    assert!(models.is_sorted_by_key(|model| model.number));
    let mug = models.iter().find(|model| model.number == Some(25));
    let mug = mug.unwrap();
    assert_eq!(mug.name, "mug");
    assert_eq!(
        model_folder::open(&mug.path).unwrap().mesh,
        ply::open(&mug.path).unwrap()
    );
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn rgbd_sequence_is_written_as_it_was_read() {
    let original = rgbd_sequence::RgbdSequence::open(&test_data::path("kitchen-sequence")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (camera, down) = (*original.camera(), original.gravity_in_world());
    let mut writer = rgbd_sequence::SequenceWriter::create(folder.path(), &camera, down).unwrap();
    let mut scratch = rgbd_sequence::Scratch::default();
    let mut points = vec![Point::default(); camera.n_pixels()];
    let mut frames = Vec::new();
    for index in (0..original.n_frames()).step_by(100) {
        let pose = original.fill(index, &mut scratch, &mut points).unwrap();
        let depth_mm: Vec<u16> = points
            .iter()
            .map(|p| (1000.0 * p.z).round() as u16)
            .collect();
        let color: Vec<u8> = points.iter().flat_map(|p| p.color.rgb()).collect();
        let view = rgbd_sequence::FrameView {
            color: &color,
            depth_mm: &depth_mm,
            instances: None,
            world_from_camera: pose,
            truth: None,
        };
        writer.write(&view).unwrap();
        frames.push((points.clone(), pose.unwrap()));
    }
    let copy = rgbd_sequence::RgbdSequence::open(folder.path()).unwrap();
    assert_eq!((copy.camera(), copy.n_frames()), (&camera, frames.len()));
    for (index, (expected, expected_pose)) in frames.iter().enumerate() {
        let pose = copy
            .fill(index, &mut scratch, &mut points)
            .unwrap()
            .unwrap();
        let bits = |p: &Point| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), p.color.0];
        let mut pairs = points.iter().zip(expected);
        assert!(
            pairs.all(|(left, right)| bits(left) == bits(right)),
            "frame {index}"
        );
        let difference = pose.to_homogeneous() - expected_pose.to_homogeneous();
        assert!(difference.amax() < 1e-14, "frame {index}: {difference}");
    }
}
