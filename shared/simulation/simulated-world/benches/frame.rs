//! Benchmarks of a simulated frame on one core, with 1, 10 and 30 objects: physics steps, the
//! clone of the world that a late command needs, and the camera.

use divan::{Bencher, black_box};
use geometry::PinholeCamera;
use point_cloud::Point;
use simulated_world::{
    ArmMount, CameraMount, ModelLibrary, STEPS_PER_SECOND, Scene, SceneKind, SimulatedKinect, World,
};

const N_OBJECTS: [usize; 3] = [1, 10, 30];
/// Physics steps between two frames at 30 Hz.
const STEPS_PER_FRAME: u32 = STEPS_PER_SECOND / 30;

fn main() {
    divan::main();
}

/// World with an arm; 30 objects form a pile.
fn world(n_objects: usize) -> World {
    let kind = if n_objects > 10 {
        SceneKind::Pile
    } else {
        SceneKind::Isolated
    };
    let mut library = ModelLibrary::generated();
    let scene =
        Scene::generate(kind, n_objects, 2, &mut library).expect("the table is large enough");
    let scene = Scene {
        arm: Some(ArmMount::default()),
        ..scene
    };
    World::new(scene, library).expect("generated objects are sound")
}

fn look(bencher: Bencher<'_, '_>, mut world: World, orbit_deg: f64) {
    let camera = PinholeCamera::KINECT_V1;
    let mut kinect = SimulatedKinect::new(&world, camera).expect("the camera is nominal");
    let mut points = vec![Point::default(); camera.n_pixels()];
    let mut frame = 0;
    bencher.bench_local(move || {
        frame += 1;
        if orbit_deg > 0.0 {
            world.set_camera(CameraMount {
                azimuth_deg: f64::from(frame as u32) * orbit_deg,
                ..CameraMount::default()
            });
        }
        black_box(kinect.look(&world, frame, &mut points)).expect("sizes agree");
    });
}

#[divan::bench(args = N_OBJECTS)]
fn camera_that_stands(bencher: Bencher<'_, '_>, n_objects: usize) {
    look(bencher, world(n_objects), 0.0);
}

#[divan::bench(args = N_OBJECTS)]
fn camera_that_moves(bencher: Bencher<'_, '_>, n_objects: usize) {
    look(bencher, world(n_objects), 0.5);
}

#[divan::bench(args = N_OBJECTS)]
fn physics_of_a_frame(bencher: Bencher<'_, '_>, n_objects: usize) {
    let mut world = world(n_objects);
    bencher.bench_local(move || {
        for _ in 0..STEPS_PER_FRAME {
            world.step();
        }
    });
}

#[divan::bench(args = N_OBJECTS)]
fn copy_of_the_world(bencher: Bencher<'_, '_>, n_objects: usize) {
    let world = world(n_objects);
    bencher.bench_local(|| black_box(world.clone()));
}
