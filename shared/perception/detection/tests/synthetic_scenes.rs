//! Detection on rendered scenes with known ground truth, and on degenerate images.

mod synthetic;

use constraint::Ternary;
use detection::{
    Config, Detection, DetectionInput, Execution, ScenePriors, Support, Workspace, detect,
};
use geometry::Plane;
use nalgebra::{Point3, Unit, Vector3};
use point_cloud::{OrganizedCloud, Point, Rgba};
use proptest::prelude::*;
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

fn found(points: &[Point], size: (usize, usize), up: Option<Unit<Vector3<f64>>>) -> Detection {
    let mut detection = Detection::default();
    let cloud = OrganizedCloud::new(points, size.0, size.1).expect("a full grid");
    let frame = DetectionInput {
        cloud,
        up_in_camera: up,
        priors: ScenePriors::default(),
    };
    detect(
        &frame,
        &Config::default(),
        &mut Workspace::default(),
        &mut detection,
        Execution::default(),
    )
    .expect("an organised cloud");
    detection
}

/// Number of candidates that are object hypotheses before the rule.
fn n_objects(detection: &Detection) -> usize {
    let objects = detection.candidates.iter().filter(|c| c.is_hypothesis());
    objects.count()
}

#[test]
fn detection_finds_boxes_at_their_true_pose() {
    let points = render(&[RED, BLUE], 1.0);
    let up = Unit::new_normalize(camera_from_table() * Vector3::z());
    // The near corners of the table are outside of the image.
    let seen_share = 0.78..0.9;
    for known_up in [None, Some(up)] {
        let detection = found(&points, (640, 480), known_up);
        let table = detection.table().unwrap();
        assert!(table.plane.normal.angle(&up) < 0.01);
        assert!(
            table
                .plane
                .height_m(&(camera_from_table() * Point3::origin()))
                .abs()
                < 0.002
        );
        // The optical axis meets the table near its middle.
        let ray = table.plane.offset_m / table.plane.normal.z;
        assert!((table.middle_depth_m() - ray.abs()).abs() < 0.15);
        assert!(
            seen_share.contains(&(table.polygon.area_m2() / 0.96)),
            "{}",
            table.polygon.area_m2()
        );
        assert_eq!(detection.candidates.len(), 2);
        for solid in [RED, BLUE] {
            let centre = Point3::new(solid.centre[0], solid.centre[1], 0.5 * solid.sides[2]);
            let candidate = detection
                .candidates
                .iter()
                .find(|c| (c.oriented_box.centre() - camera_from_table() * centre).norm() < 0.02)
                .unwrap_or_else(|| panic!("{solid:?} in {:?}", detection.candidates));
            let (mut sides, mut truth) =
                (candidate.oriented_box.sides_m(), Vector3::from(solid.sides));
            assert!(sides.x >= sides.y);
            sides.as_mut_slice().sort_by(f64::total_cmp);
            truth.as_mut_slice().sort_by(f64::total_cmp);
            assert!((sides - truth).amax() < 0.012, "{sides} for {truth}");
            assert_eq!(candidate.mean_rgb, solid.rgb.map(f32::from));
            assert_eq!(candidate.support, Some(Support::Table));
            assert_eq!(candidate.verdict, Ternary::True, "{candidate:?}");
            assert!(!candidate.touches_image_border);
        }
        let distances: Vec<f64> = detection
            .candidates
            .iter()
            .map(|c| c.centroid.coords.norm())
            .collect();
        assert!(distances.is_sorted());
    }
}

#[test]
fn segmentation_separates_a_stack() {
    let detection = found(&render(&stack(), 1.0), (640, 480), None);
    let colours: Vec<(Option<Support>, f32)> = detection
        .candidates
        .iter()
        .map(|c| (c.support, c.mean_rgb[0].round()))
        .collect();
    assert_eq!(detection.candidates.len(), 2, "{colours:?}");
    for (support, red) in colours {
        assert!(if red > 100.0 {
            support == Some(Support::Table)
        } else {
            support == Some(Support::Object)
        });
        assert!(
            (red - 200.0).abs() < 8.0 || (red - 30.0).abs() < 8.0,
            "{red}"
        );
    }
}

#[test]
fn candidates_share_no_points() {
    let detection = found(&render(&[RED, BLUE], 1.0), (640, 480), None);
    let mut indices = detection.point_indices.clone();
    indices.sort_unstable();
    indices.dedup();
    assert_eq!(indices.len(), detection.point_indices.len());
    let n_ranged: usize = detection
        .candidates
        .iter()
        .map(|c| detection.points_of(c).len())
        .sum();
    assert_eq!(n_ranged, detection.point_indices.len());
}

#[test]
fn image_border_flag_marks_a_cut_object() {
    let cut = BoxOnTable {
        centre: [-0.47, 0.0],
        bottom: 0.0,
        sides: [0.12, 0.1, 0.2],
        rgb: [9, 9, 9],
    };
    let detection = found(&render(&[cut, BLUE], 1.0), (640, 480), None);
    let marks: Vec<bool> = detection
        .candidates
        .iter()
        .map(|c| c.touches_image_border)
        .collect();
    assert_eq!(
        marks.iter().filter(|&&mark| mark).count(),
        1,
        "{:?}",
        detection.candidates
    );
    assert_eq!(marks.len(), 2);
}

#[test]
fn support_is_required_unless_the_base_is_occluded() {
    // A thin plate 0.2 m over the table; only its top is rendered.
    let mut points = render(&[BLUE], 0.0);
    let camera_from_table = camera_from_table();
    let plate = |points: &mut [Point], front: f64| {
        let table_from_camera = camera_from_table.inverse();
        for point in points.iter_mut() {
            let eye = table_from_camera * Point3::origin();
            let at = table_from_camera * point.position();
            let t = (0.2 - eye.z) / (at.z - eye.z);
            let hit = eye + (at - eye) * t;
            if (0.0..1.0).contains(&t)
                && (-0.35..-0.2).contains(&hit.x)
                && (front..front + 0.1).contains(&hit.y)
            {
                let p = camera_from_table * hit;
                (point.x, point.y, point.z) = (p.x as f32, p.y as f32, p.z as f32);
            }
        }
    };
    plate(&mut points, -0.1);
    let hanging = found(&points, (640, 480), None);
    let verdicts: Vec<Ternary> = hanging.candidates.iter().map(|c| c.verdict).collect();
    assert_eq!(verdicts.len(), 2);
    assert!(verdicts.contains(&Ternary::True) && verdicts.contains(&Ternary::False));
    assert_eq!(n_objects(&hanging), 1);
    // A box with its lower part occluded by a taller one.
    let tall = BoxOnTable {
        centre: [-0.27, -0.17],
        bottom: 0.0,
        sides: [0.25, 0.05, 0.24],
        rgb: [0, 200, 0],
    };
    let mut points = render(&[BLUE, tall], 0.0);
    let before = n_objects(&found(&points, (640, 480), None));
    let low = BoxOnTable {
        centre: [-0.27, 0.02],
        bottom: 0.0,
        sides: [0.1, 0.05, 0.20],
        rgb: [200, 200, 0],
    };
    points.clone_from(&render(&[BLUE, tall, low], 0.0));
    let after = found(&points, (640, 480), None);
    assert_eq!((before, n_objects(&after)), (2, 3));
}

#[test]
fn detection_of_an_empty_image_has_no_table() {
    let zero = Point::default();
    let empty = Point::without_depth(Rgba::default());
    let far = Point {
        x: f32::INFINITY,
        y: f32::NEG_INFINITY,
        z: f32::MAX,
        color: Rgba::default(),
    };
    let one = Point {
        x: 0.1,
        y: 0.1,
        z: 1.0,
        color: Rgba::default(),
    };
    for point in [zero, empty, far, one] {
        let detection = found(&vec![point; 640 * 480], (640, 480), None);
        assert!(
            detection.surfaces.is_empty() && detection.candidates.is_empty(),
            "{point:?}"
        );
    }
}

#[test]
fn workspace_reuse_keeps_no_state() {
    let (mut workspace, mut detection) = (Workspace::default(), Detection::default());
    let scenes = [
        render(&[RED, BLUE], 1.0),
        vec![Point::default(); 640 * 480],
        render(&[BLUE], 1.0),
    ];
    for points in &scenes {
        let cloud = OrganizedCloud::new(points, 640, 480).unwrap();
        let frame = DetectionInput {
            cloud,
            up_in_camera: None,
            priors: ScenePriors::default(),
        };
        detect(
            &frame,
            &Config::default(),
            &mut workspace,
            &mut detection,
            Execution::default(),
        )
        .unwrap();
        assert_eq!(detection, found(points, (640, 480), None));
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
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn detection_accepts_any_bit_pattern(
        size in (2..40_usize, 2..40_usize),
        expected in prop::collection::vec((prop::array::uniform3(-1.0..1.0_f64), -5.0..5.0_f64), 0..4),
        values in prop::collection::vec((coordinate(), coordinate(), coordinate(), any::<u32>()), 1600),
        up in prop::option::of(prop::array::uniform3(-1.0..1.0_f64)),
    ) {
        let point = |(x, y, z, color)| Point { x, y, z, color: Rgba(color) };
        let points: Vec<Point> = values.into_iter().take(size.0 * size.1).map(point).collect();
        let up_in_camera = up.and_then(|up| Unit::try_new(Vector3::from(up), 1e-3));
        let cloud = OrganizedCloud::new(&points, size.0, size.1).unwrap();
        let mut detection = Detection::default();
        let surfaces = expected.into_iter().filter_map(|(normal, offset_m)| {
            let normal = Unit::try_new(Vector3::from(normal), 1e-3)?;
            Some(Plane { normal, offset_m })
        });
        let surfaces: Vec<Plane> = surfaces.collect();
        let priors = ScenePriors { surfaces: &surfaces, ..ScenePriors::default() };
        let frame = DetectionInput { cloud, up_in_camera, priors };
        detect(&frame, &Config::default(), &mut Workspace::default(), &mut detection, Execution::default()).unwrap();
        prop_assert!(detection.point_indices.iter().all(|&i| points[i as usize].is_finite()));
    }

    #[test]
    fn detection_gives_finite_boxes_with_damaged_points(
        damage in prop::collection::vec((0..640 * 480_usize, any::<[u32; 4]>()), 0..3000),
    ) {
        let mut points = render_once().clone();
        for (i, bits) in damage {
            let [x, y, z, color] = bits;
            let value = f32::from_bits;
            points[i] = Point { x: value(x), y: value(y), z: value(z), color: Rgba(color) };
        }
        let detection = found(&points, (640, 480), None);
        prop_assert!(detection.candidates.len() >= 2);
        for candidate in &detection.candidates {
            prop_assert!(candidate.centroid.iter().all(|value| value.is_finite()));
            prop_assert!(candidate.oriented_box.half_sides_m.iter().all(|side| (0.0..1.0).contains(side)));
            prop_assert!(candidate.mean_rgb.iter().all(|value| (0.0..=255.0).contains(value)));
        }
    }
}

fn render_once() -> &'static Vec<Point> {
    static SCENE: std::sync::OnceLock<Vec<Point>> = std::sync::OnceLock::new();
    SCENE.get_or_init(|| render(&[RED, BLUE], 1.0))
}
