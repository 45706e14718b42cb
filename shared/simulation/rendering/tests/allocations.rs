//! Allocation test: a frame in steady state allocates nothing.

mod synthetic;

use geometry::PinholeCamera;
use point_cloud::Point;
use rendering::kinect::{FrameSeed, KinectSensor, SensorModel};
use rendering::{Lights, Rasterizer, StaticScene};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use synthetic::TableScene;

thread_local! {
    static N_ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

struct AllocationCounter;

#[expect(unsafe_code, reason = "a global allocator needs an unsafe impl")]
// SAFETY: all calls are passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for AllocationCounter {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        N_ALLOCATIONS.with(|n| n.set(n.get() + 1));
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer comes from `System.alloc` above.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        N_ALLOCATIONS.with(|n| n.set(n.get() + 1));
        // SAFETY: the pointer comes from `System.alloc` above.
        unsafe { System.realloc(pointer, layout, new_size) }
    }
}

#[global_allocator]
static ALLOCATOR: AllocationCounter = AllocationCounter;

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
        let before = N_ALLOCATIONS.get();
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
        let n_allocations = N_ALLOCATIONS.get() - before;
        assert!(n_unoccluded > 10_000);
        assert!(frame_index < 2 || n_allocations == 0, "{n_allocations}");
    }
}
