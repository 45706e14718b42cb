//! One object of 5 000 points, chosen by index from a frame of 640 x 480: its
//! frame and its descriptor.

use description::{Descriptor, DescriptorFrame, Good, ObjectPoints, object_frame, reference_frame};
use divan::{Bencher, black_box};
use nalgebra::Point3;
use point_cloud::{Point, Rgba};

const N_POINTS: u32 = 5000;

fn main() {
    divan::main();
}

/// A frame in which a curved, lopsided object of 100 columns stands in the middle.
fn scene() -> (Vec<Point>, Vec<u32>) {
    let mut frame = vec![Point::without_depth(Rgba(0)); 640 * 480];
    let indices: Vec<u32> = (0..N_POINTS)
        .map(|i| (200 + i / 100) * 640 + 270 + i % 100)
        .collect();
    for (i, &index) in (0..).zip(&indices) {
        let (u, v) = (f64::from(i % 100) / 100.0, f64::from(i / 100) / 50.0);
        let noise = 0.002 * (f64::from(i) * 0.618_034).fract();
        frame[index as usize] = Point {
            x: (0.2 * u * u) as f32,
            y: (0.1 * v) as f32,
            z: (0.9 + 0.05 * (u - 0.3) * (u - 0.3) + noise) as f32,
            color: Rgba(0),
        };
    }
    (frame, indices)
}

fn frame_of(points: ObjectPoints<'_>) -> DescriptorFrame {
    let frame = object_frame(points, &Point3::origin()).expect("the object has many points");
    frame.descriptor_frame()
}

#[divan::bench(args = [5, 15, 50])]
fn good(bencher: Bencher<'_, '_>, n_bins: usize) {
    let (cloud, indices) = scene();
    let points = ObjectPoints::selected(&cloud, &indices).expect("the indices fit");
    let frame = frame_of(points);
    let mut good = Good::new(n_bins, 0.0015).expect("the parameters are valid");
    let mut out = Vec::new();
    bencher.bench_local(|| good.compute(black_box(points), &frame, &mut out));
}

#[divan::bench]
fn own_frame(bencher: Bencher<'_, '_>) {
    let (cloud, indices) = scene();
    let points = ObjectPoints::selected(&cloud, &indices).expect("the indices fit");
    bencher.bench_local(|| object_frame(black_box(points), &Point3::origin()));
}

#[divan::bench]
fn frame_of_the_reference(bencher: Bencher<'_, '_>) {
    let (cloud, indices) = scene();
    let points = ObjectPoints::selected(&cloud, &indices).expect("the indices fit");
    bencher.bench_local(|| reference_frame(black_box(points)));
}
