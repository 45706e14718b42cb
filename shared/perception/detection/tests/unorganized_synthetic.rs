//! Detection in unorganised clouds with known ground truth, and in degenerate clouds.

mod synthetic;

use detection::{
    Config, Detection, DetectionInput, Execution, ScenePriors, Support, Workspace, detect,
};
use nalgebra::{Isometry3, Unit, Vector3};
use point_cloud::{OrganizedCloud, Point, Rgba};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::OnceLock;
use synthetic::{BoxOnTable, camera_from_table, render, stack};

const RED: BoxOnTable = BoxOnTable {
    centre: [-0.25, 0.0],
    bottom: 0.0,
    sides: [0.10, 0.06, 0.15],
    rgb: [200, 30, 30],
};
const BLUE: BoxOnTable = BoxOnTable {
    centre: [0.20, 0.10],
    bottom: 0.0,
    sides: [0.20, 0.08, 0.05],
    rgb: [30, 30, 200],
};
const GREEN: BoxOnTable = BoxOnTable {
    centre: [0.05, -0.15],
    bottom: 0.0,
    sides: [0.07, 0.07, 0.10],
    rgb: [30, 200, 30],
};

fn found_with(points: &[Point], up: Option<Vector3<f64>>, workspace: &mut Workspace) -> Detection {
    let mut detection = Detection::default();
    let frame = DetectionInput {
        cloud: OrganizedCloud::new(points, points.len(), 1).expect("a row"),
        up_in_camera: up.map(Unit::new_normalize),
        priors: ScenePriors::default(),
    };
    detect(
        &frame,
        &Config::default(),
        workspace,
        &mut detection,
        Execution::default(),
    )
    .expect("a small cloud");
    detection
}

fn found(points: &[Point], up: Option<Vector3<f64>>) -> Detection {
    found_with(points, up, &mut Workspace::default())
}

fn without_gaps(points: &[Point]) -> Vec<Point> {
    points.iter().copied().filter(Point::is_finite).collect()
}

/// Points in a deterministic pseudo-random order.
fn shuffled(points: &[Point]) -> Vec<Point> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_key(|&i| (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    order.into_iter().map(|i| points[i]).collect()
}

fn moved(points: &[Point], transform: &Isometry3<f64>) -> Vec<Point> {
    let each = |point: &Point| {
        let p = transform * point.position();
        Point {
            x: p.x as f32,
            y: p.y as f32,
            z: p.z as f32,
            color: point.color,
        }
    };
    points.iter().map(each).collect()
}

/// Two views of a table from opposite sides, merged in the table's frame.
fn merged(boxes: &[BoxOnTable]) -> Vec<Point> {
    let table_from_camera = camera_from_table().inverse();
    let half_turn = Isometry3::rotation(Vector3::z() * PI);
    let turned: Vec<BoxOnTable> = boxes
        .iter()
        .map(|solid| BoxOnTable {
            centre: solid.centre.map(|x| -x),
            ..*solid
        })
        .collect();
    let mut points = moved(&without_gaps(&render(boxes, 1.0)), &table_from_camera);
    points.extend(moved(
        &without_gaps(&render(&turned, 1.0)),
        &(half_turn * table_from_camera),
    ));
    points
}

/// Greatest intersection over union of a candidate's points with those of a box.
fn overlap(detection: &Detection, points: &[Point], solid: &BoxOnTable) -> f64 {
    let is_of_box = |point: &Point| point.color.rgb() == solid.rgb;
    let n_box = points.iter().filter(|point| is_of_box(point)).count();
    detection
        .candidates
        .iter()
        .map(|candidate| {
            let indices = detection.points_of(candidate);
            let both = indices
                .iter()
                .filter(|&&i| is_of_box(&points[i as usize]))
                .count();
            both as f64 / (n_box + indices.len() - both) as f64
        })
        .fold(0.0, f64::max)
}

#[test]
fn unorganized_single_view_matches_its_image_in_any_order() {
    let image = render(&[RED, BLUE, GREEN], 1.0);
    let row = without_gaps(&image);
    for points in [row.clone(), shuffled(&row)] {
        let detection = found(&points, None);
        assert_eq!(detection.candidates.len(), 3);
        for solid in [RED, BLUE, GREEN] {
            // The lowest points of a box count as table.
            let overlap = overlap(&detection, &points, &solid);
            assert!(overlap > 0.8, "{overlap} of {solid:?}");
        }
        let marks = |candidate: &detection::Candidate| candidate.touches_image_border;
        assert!(!detection.candidates.iter().any(marks));
        for candidate in &detection.candidates {
            assert!(detection.points_of(candidate).is_sorted());
        }
    }
}

#[test]
fn unorganized_column_matches_row() {
    let points = without_gaps(&render(&[RED, BLUE], 1.0));
    let mut detection = Detection::default();
    let frame = DetectionInput {
        cloud: OrganizedCloud::new(&points, 1, points.len()).unwrap(),
        up_in_camera: None,
        priors: ScenePriors::default(),
    };
    detect(
        &frame,
        &Config::default(),
        &mut Workspace::default(),
        &mut detection,
        Execution::default(),
    )
    .unwrap();
    assert_eq!(detection, found(&points, None));
    assert_eq!(detection.candidates.len(), 2);
}

#[test]
fn unorganized_single_view_tolerates_points_off_their_pixels() {
    // Rounded to millimetres, as in text files, and rotated about the optical axis.
    let row = without_gaps(&render(&[RED, BLUE, GREEN], 1.0));
    let turned = moved(&row, &Isometry3::rotation(Vector3::z() * 0.1));
    let round = |value: f32| (value * 1000.0).round() / 1000.0;
    let points: Vec<Point> = turned
        .iter()
        .map(|p| Point {
            x: round(p.x),
            y: round(p.y),
            z: round(p.z),
            color: p.color,
        })
        .collect();
    let detection = found(&shuffled(&points), None);
    assert_eq!(detection.candidates.len(), 3);
    for solid in [RED, BLUE, GREEN] {
        let overlap = overlap(&detection, &shuffled(&points), &solid);
        assert!(overlap > 0.75, "{overlap} of {solid:?}");
    }
}

#[test]
fn unorganized_merged_views_in_the_world_frame() {
    let boxes = [RED, BLUE, GREEN];
    let in_table = merged(&boxes);
    let yaw = Vector3::z() * 0.7;
    for world_from_table in [
        Isometry3::new(Vector3::new(3.0, -2.0, 0.7), yaw),
        Isometry3::new(Vector3::new(0.0, 0.0, 0.0), yaw),
        Isometry3::new(Vector3::new(-40.0, 15.0, 1.2), yaw),
    ] {
        let points = moved(&in_table, &world_from_table);
        for (points, up) in [
            (points.clone(), Some(Vector3::z())),
            (points.clone(), None),
            (shuffled(&points), Some(Vector3::z())),
        ] {
            let detection = found(&points, up);
            let table = detection.table().expect("a table");
            assert!(table.plane.normal.angle(&Vector3::z()) < 0.01);
            assert!((table.polygon.area_m2() / 0.96 - 1.0).abs() < 0.08);
            assert_eq!(detection.candidates.len(), 3, "{world_from_table} {up:?}");
            for solid in boxes {
                let overlap = overlap(&detection, &points, &solid);
                assert!(overlap > 0.8, "{overlap} of {solid:?}");
            }
            for candidate in &detection.candidates {
                assert_eq!(candidate.support, Some(Support::Table));
                assert!(!candidate.touches_image_border);
            }
        }
    }
}

#[test]
fn unorganized_merged_views_in_the_camera_frame() {
    let boxes = [RED, BLUE, GREEN];
    let points = moved(&merged(&boxes), &camera_from_table());
    let up = camera_from_table() * Vector3::z();
    for up in [Some(up), None] {
        let detection = found(&points, up);
        assert_eq!(detection.candidates.len(), 3, "{up:?}");
        for solid in boxes {
            let overlap = overlap(&detection, &points, &solid);
            assert!(overlap > 0.8, "{overlap} of {solid:?}");
        }
    }
}

#[test]
fn unorganized_sparse_cloud_uses_larger_cells() {
    // One point per cell of 12 mm.
    let mut cells = std::collections::BTreeSet::new();
    let mut points = merged(&[RED, BLUE, GREEN]);
    points.retain(|p| cells.insert([p.x, p.y, p.z].map(|x| (x / 0.012).floor() as i32)));
    let detection = found(&points, Some(Vector3::z()));
    assert_eq!(detection.candidates.len(), 3);
    for solid in [RED, BLUE, GREEN] {
        let overlap = overlap(&detection, &points, &solid);
        assert!(overlap > 0.7, "{overlap} of {solid:?}");
    }
}

#[test]
fn unorganized_support_is_absent_over_visible_table() {
    let table_from_camera = camera_from_table().inverse();
    let below = render(&[BLUE], 1.0);
    let plate = BoxOnTable {
        centre: [-0.3, 0.0],
        bottom: 0.2,
        sides: [0.15, 0.1, 0.01],
        rgb: [0, 200, 0],
    };
    // The plate is added after the table was seen.
    let with_plate = render(&[BLUE, plate], 1.0);
    let mut points = moved(&without_gaps(&below), &table_from_camera);
    points.extend(moved(&without_gaps(&with_plate), &table_from_camera));
    let n_carried = |detection: &Detection| {
        let carried = |c: &&detection::Candidate| c.support.is_some();
        detection.candidates.iter().filter(carried).count()
    };
    assert_eq!(n_carried(&found(&points, Some(Vector3::z()))), 1);
    // With the table below it never seen, it may stand on something.
    points.retain(|p| !(p.z < 0.02 && (-0.39..-0.21).contains(&p.x) && p.y.abs() < 0.06));
    let detection = found(&points, Some(Vector3::z()));
    let hidden = |c: &&detection::Candidate| c.support == Some(Support::Occluded);
    assert_eq!(n_carried(&detection), 2);
    assert_eq!(detection.candidates.iter().filter(hidden).count(), 1);
}

#[test]
fn unorganized_table_above_the_origin_is_no_view_from_below() {
    let boxes = [RED, BLUE, GREEN];
    let one_view = moved(
        &without_gaps(&render(&boxes, 1.0)),
        &camera_from_table().inverse(),
    );
    for mut in_table in [merged(&boxes), one_view] {
        in_table.retain(|p| p.z > -0.05 && p.x.abs() < 0.7 && p.y.abs() < 0.5);
        let points = moved(&in_table, &Isometry3::translation(0.1, 0.05, 0.8));
        for up in [None, Some(Vector3::z())] {
            let detection = found(&points, up);
            assert_eq!(detection.candidates.len(), 3, "{up:?}");
            for solid in boxes {
                let overlap = overlap(&detection, &points, &solid);
                assert!(overlap > 0.75, "{overlap} of {solid:?}");
            }
        }
    }
}

#[test]
fn unorganized_stack_is_split_by_a_virtual_view() {
    let [low, high] = stack();
    let points = merged(&[low, high]);
    let detection = found(&points, Some(Vector3::z()));
    assert_eq!(detection.candidates.len(), 2);
    for solid in [low, high] {
        let overlap = overlap(&detection, &points, &solid);
        assert!(overlap > 0.7, "{overlap} of {solid:?}");
    }
    let on_object = |c: &&detection::Candidate| c.support == Some(Support::Object);
    assert_eq!(detection.candidates.iter().filter(on_object).count(), 1);
}

#[test]
fn unorganized_degenerate_clouds_have_no_table() {
    let at = |x: f32, y: f32, z: f32| Point {
        x,
        y,
        z,
        color: Rgba::default(),
    };
    let line = |i: u32| at(0.001 * i as f32, 0.002 * i as f32, 0.5 + 0.003 * i as f32);
    let clouds = [
        vec![at(0.1, 0.1, 1.0)],
        vec![at(0.1, 0.1, 1.0); 5000],
        vec![at(0.0, 0.0, 0.0); 5000],
        vec![at(f32::NAN, 0.0, 1.0); 5000],
        vec![at(f32::INFINITY, f32::NEG_INFINITY, f32::MAX); 5000],
        vec![at(1e30, -1e30, 1e30); 5000],
        vec![at(1e-42, 1e-42, 1e-42); 5000],
        (0..5000).map(line).collect(),
    ];
    for points in clouds {
        for up in [None, Some(Vector3::z())] {
            let detection = found(&points, up);
            assert!(detection.surfaces.is_empty() && detection.candidates.is_empty());
            assert!(detection.point_indices.is_empty());
        }
    }
}

#[test]
fn unorganized_empty_table_has_no_candidates() {
    for (points, up) in [
        (without_gaps(&render(&[], 1.0)), None),
        (merged(&[]), Some(Vector3::z())),
    ] {
        let detection = found(&points, up);
        assert!(!detection.surfaces.is_empty() && detection.candidates.is_empty());
    }
}

#[test]
fn unorganized_workspace_reuse_keeps_no_state() {
    let clouds = [
        merged(&[RED, BLUE]),
        without_gaps(&render(&[GREEN], 1.0)),
        vec![Point::default(); 40],
        merged(&[GREEN]),
        without_gaps(&render(&[RED, BLUE], 1.0)),
    ];
    let mut workspace = Workspace::default();
    for points in &clouds {
        let up = Some(Vector3::z()).filter(|_| points[0].z < 0.3);
        assert_eq!(
            found_with(points, up, &mut workspace),
            found(points, up),
            "{} points",
            points.len()
        );
    }
}

#[test]
fn unorganized_hypotheses_are_limited_to_the_largest() {
    // A floor of 20 m by 20 m with a cube of 3 cm every 20 cm.
    let at = |x: f64, y: f64, z: f64| Point {
        x: x as f32,
        y: y as f32,
        z: z as f32,
        color: Rgba::default(),
    };
    let mut points: Vec<Point> = (0..1000 * 1000)
        .map(|i| {
            at(
                f64::from(i % 1000) * 0.02,
                f64::from(i / 1000) * 0.02,
                1e-3 * f64::from(i % 7),
            )
        })
        .collect();
    for cube in 0..98 * 98 {
        let (x, y) = (
            0.2 * f64::from(cube % 98 + 1),
            0.2 * f64::from(cube / 98 + 1),
        );
        for i in 0..6 * 6 * 6 {
            let [a, b, c] = [i % 6, i / 6 % 6, i / 36].map(|step| 0.006 * f64::from(step));
            points.push(at(x + a, y + b, 0.01 + c));
        }
    }
    let detection = found(&points, Some(Vector3::z()));
    assert!(!detection.surfaces.is_empty());
    assert!((1..=512).contains(&detection.candidates.len()));
}

/// Ten million points of a room with a table, in the world frame.
#[test]
#[ignore = "takes seconds and a gigabyte"]
fn unorganized_detection_handles_ten_million_points() {
    let dense = |points: &[Point]| -> Vec<Point> {
        let jitter = |i: usize, k: f64| (((i as f64 * k).fract() - 0.5) * 0.002) as f32;
        let more = |i: usize| {
            let point = points[i % points.len()];
            Point {
                x: point.x + jitter(i, 0.618_033_988),
                y: point.y + jitter(i, 0.414_213_562),
                z: point.z + jitter(i, 0.732_050_807),
                color: point.color,
            }
        };
        (0..10_000_000).map(more).collect()
    };
    let view = without_gaps(&render(&[RED, BLUE, GREEN], 1.0));
    let both = merged(&[RED, BLUE, GREEN]);
    let mut workspace = Workspace::default();
    for (points, up) in [
        (dense(&view), None),
        (shuffled(&dense(&view)), None),
        (dense(&both), Some(Vector3::z())),
        (shuffled(&dense(&both)), Some(Vector3::z())),
    ] {
        let detection = found_with(&points, up, &mut workspace);
        assert_eq!(detection.candidates.len(), 3);
    }
}

/// Strategy for floats of every kind, many of them near a table.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => -1.5..1.5_f32,
        2 => 0.3..2.2_f32,
        1 => any::<u32>().prop_map(f32::from_bits),
        1 => Just(f32::NAN),
        1 => Just(0.0),
        1 => Just(1e30),
        1 => Just(1e-42),
    ]
}

fn scene() -> &'static Vec<Point> {
    static SCENE: OnceLock<Vec<Point>> = OnceLock::new();
    SCENE.get_or_init(|| {
        shuffled(&merged(&[RED, BLUE]))
            .into_iter()
            .take(60_000)
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn unorganized_detection_accepts_any_bit_pattern(
        values in prop::collection::vec((coordinate(), coordinate(), coordinate(), any::<u32>()), 1..2500),
        up in prop::option::of(prop::array::uniform3(-1.0..1.0_f64)),
        is_column in any::<bool>(),
    ) {
        let point = |(x, y, z, color)| Point { x, y, z, color: Rgba(color) };
        let points: Vec<Point> = values.into_iter().map(point).collect();
        let (width, height) = if is_column { (1, points.len()) } else { (points.len(), 1) };
        let cloud = OrganizedCloud::new(&points, width, height).unwrap();
        let up_in_camera = up.and_then(|up| Unit::try_new(Vector3::from(up), 1e-3));
        let frame = DetectionInput { cloud, up_in_camera, priors: ScenePriors::default() };
        let mut detection = Detection::default();
        detect(&frame, &Config::default(), &mut Workspace::default(), &mut detection, Execution::default()).unwrap();
        prop_assert!(detection.point_indices.iter().all(|&i| points[i as usize].is_finite()));
    }

    #[test]
    fn unorganized_detection_gives_finite_boxes_with_damaged_points(
        damage in prop::collection::vec((0..60_000_usize, any::<[u32; 4]>()), 0..2000),
    ) {
        let mut points = scene().clone();
        for (i, [x, y, z, color]) in damage {
            let value = f32::from_bits;
            points[i] = Point { x: value(x), y: value(y), z: value(z), color: Rgba(color) };
        }
        let detection = found(&points, Some(Vector3::z()));
        prop_assert!(detection.candidates.len() >= 2);
        let mut indices = detection.point_indices.clone();
        indices.sort_unstable();
        indices.dedup();
        prop_assert_eq!(indices.len(), detection.point_indices.len());
        for candidate in &detection.candidates {
            prop_assert!(candidate.centroid.iter().all(|value| value.is_finite()));
            prop_assert!(candidate.oriented_box.half_sides_m.iter().all(|side| (0.0..1.0).contains(side)));
        }
    }
}
