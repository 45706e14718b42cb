//! Parallelism test: the result does not depend on the number of threads.

#[path = "synthetic/scene_priors.rs"]
mod scene_priors;
#[path = "synthetic/scoped_threads.rs"]
mod scoped_threads;
mod synthetic;

use detection::{
    Config, Detection, DetectionInput, Execution, Parallelism, ScenePriors, Sequential, Workspace,
    detect,
};
use geometry::{Plane, RigidTransform};
use point_cloud::{OrganizedCloud, Point};
use scoped_threads::ScopedThreads;
use synthetic::{BoxOnTable, render};

/// Detections of rendered boxes with two tracks and a robot link, frame by frame.
fn searched(points: &[Point], parallelism: &dyn Parallelism) -> Vec<Detection> {
    let (tracks, links) = (scene_priors::tracks(), [scene_priors::link()]);
    let config = Config::default();
    let mut workspace = Workspace::default();
    let mut surfaces: Vec<Plane> = Vec::new();
    let mut search = || {
        let frame = DetectionInput {
            cloud: OrganizedCloud::new(points, 640, 480).expect("an image"),
            up_in_camera: None,
            priors: ScenePriors {
                instructor: None,
                robot: Some(&links),
                bodies: None,
                world_from_camera: RigidTransform::identity(),
                surfaces: &surfaces,
                tracks: &tracks,
            },
        };
        let mut detection = Detection::default();
        let execution = Execution {
            parallelism,
            observer: None,
        };
        detect(&frame, &config, &mut workspace, &mut detection, execution).expect("an image");
        surfaces = detection
            .surfaces
            .iter()
            .map(|surface| surface.plane)
            .collect();
        detection
    };
    (0..6).map(|_| search()).collect()
}

#[test]
fn parallelism_does_not_change_the_result() {
    let solid = |x: f64, bottom: f64, sides: [f64; 3]| BoxOnTable {
        centre: [x, 0.0],
        bottom,
        sides,
        rgb: [200, 30, 30],
    };
    let boxes = [
        solid(-0.3, 0.0, [0.1, 0.07, 0.12]),
        solid(0.0, 0.0, [0.24, 0.16, 0.06]),
        solid(0.02, 0.06, [0.08, 0.06, 0.14]),
        solid(0.25, 0.0, [0.1, 0.07, 0.12]),
    ];
    let points = render(&boxes, 1.0);
    let alone = searched(&points, &Sequential);
    assert!(alone.iter().all(|found| found.candidates.len() >= 4));
    for n_threads in [2, 3, 8] {
        assert!(
            searched(&points, &ScopedThreads(n_threads)) == alone,
            "{n_threads} threads"
        );
    }
}
