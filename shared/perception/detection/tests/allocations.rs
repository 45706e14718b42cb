//! Allocation test: detection of a frame in steady state allocates nothing.

#[path = "synthetic/scene_priors.rs"]
mod scene_priors;
mod synthetic;

use allocation_counter::CountingAllocator;
use detection::{
    BodyMap, Candidate, Config, Detection, DetectionInput, Execution, ScenePriors, Workspace,
    detect,
};
use geometry::{Plane, RigidTransform};
use point_cloud::OrganizedCloud;
use synthetic::{BoxOnTable, camera_from_table, render};

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Number of allocations of this thread.
fn n_allocations() -> u64 {
    CountingAllocator::counts_of_thread().0
}

#[test]
fn organized_detection_allocates_nothing_in_steady_state() {
    let solid = |x: f64| BoxOnTable {
        centre: [x, 0.0],
        bottom: 0.0,
        sides: [0.1, 0.07, 0.12],
        rgb: [5; 3],
    };
    let arm = BoxOnTable {
        centre: [0.1, 0.45],
        bottom: 0.15,
        sides: [0.08, 0.5, 0.07],
        rgb: [5; 3],
    };
    let objects = [solid(-0.3), solid(0.0), solid(0.25)];
    // The arm comes after some frames, because only what moves is a body.
    let without_arm = render(&objects, 1.0);
    let with_arm = render(&[&objects[..], &[arm]].concat(), 1.0);
    let (mut workspace, mut detection) = (Workspace::default(), Detection::default());
    let config = Config::default();
    let mut bodies = BodyMap::default();
    let (tracks, links) = (scene_priors::tracks(), [scene_priors::link()]);
    let mut table: Option<Plane> = None;
    for number in 0..55 {
        let has_arm = number >= 15;
        let points = if has_arm { &with_arm } else { &without_arm };
        let frame = DetectionInput {
            cloud: OrganizedCloud::new(points, 640, 480).unwrap(),
            up_in_camera: None,
            priors: ScenePriors {
                instructor: None,
                robot: Some(&links),
                bodies: Some(&bodies),
                world_from_camera: RigidTransform::identity(),
                surfaces: if number < 5 { &[] } else { table.as_slice() },
                tracks: &tracks,
            },
        };
        let before = n_allocations();
        detect(
            &frame,
            &config,
            &mut workspace,
            &mut detection,
            Execution::default(),
        )
        .unwrap();
        let n_allocations = n_allocations() - before;
        bodies.assign(&detection.bodies);
        table = detection.table().map(|table| table.plane);
        assert_eq!(bodies.is_any(), has_arm);
        assert!(detection.candidates.len() >= 3);
        let is_limb = |c: &Candidate| c.findings.is_person_or_robot();
        assert!(!has_arm || detection.candidates.iter().any(is_limb));
        if number >= 35 {
            assert_eq!(n_allocations, 0, "in frame {number}");
        }
    }
}

/// Allowed allocations of the voxel path: a polygon per searched plane and those of the
/// virtual views.
const VOXEL_ALLOCATIONS_MAX: u64 = 60;

#[test]
fn unorganized_detection_allocates_only_polygons_in_steady_state() {
    let solid = |x: f64, bottom: f64, sides: [f64; 3]| BoxOnTable {
        centre: [x, 0.0],
        bottom,
        sides,
        rgb: [5; 3],
    };
    let boxes = [
        solid(-0.3, 0.0, [0.1, 0.07, 0.12]),
        solid(0.15, 0.0, [0.24, 0.16, 0.06]),
        solid(0.15, 0.06, [0.08, 0.06, 0.14]),
    ];
    let mut view = render(&boxes, 1.0);
    view.retain(point_cloud::Point::is_finite);
    let table_from_camera = camera_from_table().inverse();
    let in_table = |point: &point_cloud::Point| {
        let p = table_from_camera * point.position();
        let [x, y, z] = [p.x as f32, p.y as f32, p.z as f32];
        point_cloud::Point { x, y, z, ..*point }
    };
    let turned: Vec<_> = view.iter().map(in_table).collect();
    for (points, n_max) in [(&view, 0), (&turned, VOXEL_ALLOCATIONS_MAX)] {
        let cloud = OrganizedCloud::new(points, points.len(), 1).unwrap();
        let (mut workspace, mut detection) = (Workspace::default(), Detection::default());
        let config = Config::default();
        for number in 0..40 {
            let frame = DetectionInput {
                cloud,
                up_in_camera: None,
                priors: ScenePriors::default(),
            };
            let before = n_allocations();
            detect(
                &frame,
                &config,
                &mut workspace,
                &mut detection,
                Execution::default(),
            )
            .unwrap();
            let n_allocations = n_allocations() - before;
            assert_eq!(detection.candidates.len(), 3);
            if number >= 20 {
                assert!(n_allocations <= n_max, "{n_allocations} in frame {number}");
            }
        }
    }
}
