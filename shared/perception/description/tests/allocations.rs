//! Allocation test: describing an object does not allocate in steady state.

use allocation_counter::CountingAllocator;
use description::{Descriptor, DescriptorFrame, Good, GoodVariant, ObjectPoints, Support};
use point_cloud::{Point, Rgba};

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Number of allocations of this thread.
fn n_allocations() -> u64 {
    CountingAllocator::counts_of_thread().0
}

const FRAME: DescriptorFrame = DescriptorFrame {
    object_from_source: [
        [1.0, 0.0, 0.0, -0.1],
        [0.0, 1.0, 0.0, -0.1],
        [0.0, 0.0, 1.0, -0.05],
    ],
};

fn cloud(n_points: u32) -> Vec<Point> {
    let point = |i: u32| {
        let t = f64::from(i);
        let at = |step: f64, side_m: f64| ((t * step).fract() * side_m) as f32;
        Point {
            x: at(0.618_034, 0.2),
            y: at(0.754_878, 0.15),
            z: at(0.569_84, 0.1),
            color: Rgba(0),
        }
    };
    (0..n_points).map(point).collect()
}

#[test]
fn description_does_not_allocate_after_the_largest_object() {
    let cloud = cloud(5000);
    let indices: Vec<u32> = (0..5000).rev().collect();
    let published = GoodVariant::Published {
        sign_threshold_m: 0.0015,
    };
    let workspace = GoodVariant::Workspace {
        support: Support::Adaptive,
    };
    for variant in [published, workspace] {
        let mut good = Good::new(15, variant).unwrap();
        let mut out = Vec::new();
        good.compute(ObjectPoints::all(&cloud), &FRAME, &mut out)
            .unwrap();
        let before = n_allocations();
        assert!(before > 0, "the first call has to allocate");
        for n in [10, 5000, 1, 4999] {
            let whole = ObjectPoints::all(&cloud[..n]);
            good.compute(whole, &FRAME, &mut out).unwrap();
            let selected = ObjectPoints::selected(&cloud, &indices[..n]).unwrap();
            good.compute(selected, &FRAME, &mut out).unwrap();
        }
        assert_eq!(n_allocations(), before);
    }
}
