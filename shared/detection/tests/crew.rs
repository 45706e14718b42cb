//! What is found does not depend on how many threads search.

mod synthetic;

use detection::{
    Alone, Config, Crew, Detection, ExpectedTrack, Frame, Surroundings, Workspace, detect_in_steps,
};
use geometry::{Capsule, OrientedBox};
use nalgebra::{Isometry3, Point3, Vector3};
use point_cloud::{OrganizedCloud, Point};
use synthetic::{BoxOnTable, camera_from_table, render};

/// Threads that are started for each piece of work.
struct Threads(usize);

impl Crew for Threads {
    fn together(&self, work: &(dyn Fn() + Sync)) {
        std::thread::scope(|scope| {
            for _ in 1..self.0 {
                scope.spawn(work);
            }
            work();
        });
    }
}

/// A pile of boxes, single ones, and an arm over one of them.
fn searched(points: &[Point], crew: &dyn Crew) -> Vec<Detection> {
    let tracks = [0.0, 0.25].map(|x| ExpectedTrack {
        shape: OrientedBox {
            frame_from_box: camera_from_table() * Isometry3::translation(x, 0.0, 0.06),
            half_sides_m: Vector3::new(0.05, 0.035, 0.06),
        },
        n_points: 3000,
    });
    let link = Capsule {
        from: Point3::new(-0.5, 0.0, 0.06),
        to: Point3::new(-0.3, 0.0, 0.06),
        radius_m: 0.05,
    };
    let links = [link.transformed(&camera_from_table())];
    let config = Config::default();
    let mut workspace = Workspace::default();
    let mut search = |seed| {
        let frame = Frame {
            cloud: OrganizedCloud::new(points, 640, 480).expect("an image"),
            up_in_camera: None,
            seed,
            surroundings: Surroundings {
                instructor: None,
                robot: Some(&links),
                tracks: &tracks,
            },
        };
        let mut detection = Detection::default();
        let on_step = &mut |_| {};
        detect_in_steps(
            &frame,
            &config,
            &mut workspace,
            &mut detection,
            crew,
            on_step,
        )
        .expect("an image");
        detection
    };
    (0..6).map(&mut search).collect()
}

#[test]
fn any_number_of_threads_finds_the_same() {
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
    let alone = searched(&points, &Alone);
    assert!(alone.iter().all(|found| found.candidates.len() >= 4));
    for n_threads in [2, 3, 8] {
        assert!(
            searched(&points, &Threads(n_threads)) == alone,
            "{n_threads} threads"
        );
    }
}
