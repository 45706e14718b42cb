//! Allocation test: a frame in steady state allocates nothing.

mod synthetic;

use allocation_counter::CountingAllocator;
use geometry::PinholeCamera;
use point_cloud::Point;
use rendering::kinect::{FrameSeed, KinectSensor, SensorModel};
use rendering::{Lights, Rasterizer, StaticScene};
use synthetic::TableScene;

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Number of allocations of this thread.
fn n_allocations() -> u64 {
    CountingAllocator::counts_of_thread().0
}

#[test]
fn rendering_and_sensing_in_steady_state_allocate_nothing() {
    let camera = PinholeCamera::KINECT_V1;
    let scene = TableScene::new(10);
    let (background, objects) = (scene.background(), scene.objects());
    let mut rasterizer = Rasterizer::new(camera).unwrap();
    let mut sensor = KinectSensor::new(camera, SensorModel::KINECT_V1).unwrap();
    let mut points = vec![Point::default(); camera.n_pixels()];
    let stage = StaticScene {
        world_from_camera: TableScene::world_from_camera(),
        lights: Lights::ROOM,
        background: &background,
    };
    for frame_index in 0..6 {
        let before = n_allocations();
        if frame_index % 2 == 0 {
            rasterizer.prepare(&stage).unwrap();
        }
        let image = rasterizer.render(&objects);
        let shot = FrameSeed {
            seed: 1,
            frame_index,
        };
        sensor.sense(image, shot, &mut points).unwrap();
        let n_unoccluded: usize = objects
            .iter()
            .map(|object| rasterizer.n_unoccluded_px(object))
            .sum();
        let n_allocations = n_allocations() - before;
        assert!(n_unoccluded > 10_000);
        assert!(frame_index < 2 || n_allocations == 0, "{n_allocations}");
    }
}
