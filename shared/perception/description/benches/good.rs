//! Benchmark of descriptors and object frames: one object of 5 000 points selected from
//! a frame of 640 x 480. The authors' programs compute frame and descriptor together.

use description::{
    AppearanceDescriptor, AppearanceWeights, Descriptor, DescriptorFrame, Good, GoodVariant,
    ObjectPoints, Support, WarpedGood, object_axes, reference_frame,
};
use divan::{Bencher, black_box};
use point_cloud::{Point, Rgba};

const N_POINTS: u32 = 5000;

fn main() {
    divan::main();
}

/// Frame with a curved asymmetric object of 100 columns in the middle.
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
    let axes = object_axes(points, None).expect("the object has many points");
    axes.object_from_source
}

fn good(bencher: Bencher<'_, '_>, n_bins: usize, variant: GoodVariant) {
    let (cloud, indices) = scene();
    let points = ObjectPoints::selected(&cloud, &indices).expect("the indices fit");
    let frame = frame_of(points);
    let mut good = Good::new(n_bins, variant).expect("the parameters are valid");
    let mut out = Vec::new();
    bencher.bench_local(|| good.compute(black_box(points), &frame, &mut out));
}

#[divan::bench(args = [5, 15, 50])]
fn published(bencher: Bencher<'_, '_>, n_bins: usize) {
    let sign_threshold_m = 0.0015;
    good(bencher, n_bins, GoodVariant::Published { sign_threshold_m });
}

#[divan::bench(args = [5, 15, 50])]
fn workspace(bencher: Bencher<'_, '_>, n_bins: usize) {
    let support = Support::Adaptive;
    good(bencher, n_bins, GoodVariant::Workspace { support });
}

#[divan::bench]
fn own_frame(bencher: Bencher<'_, '_>) {
    let (cloud, indices) = scene();
    let points = ObjectPoints::selected(&cloud, &indices).expect("the indices fit");
    bencher.bench_local(|| object_axes(black_box(points), None));
}

#[divan::bench]
fn frame_of_the_reference(bencher: Bencher<'_, '_>) {
    let (cloud, indices) = scene();
    let points = ObjectPoints::selected(&cloud, &indices).expect("the indices fit");
    bencher.bench_local(|| reference_frame(black_box(points)));
}

/// Frame and descriptor together, as the authors' programs are timed.
#[divan::bench]
fn published_15_with_its_frame(bencher: Bencher<'_, '_>) {
    let (cloud, indices) = scene();
    let points = ObjectPoints::selected(&cloud, &indices).expect("the indices fit");
    let sign_threshold_m = 0.0015;
    let variant = GoodVariant::Published { sign_threshold_m };
    let mut good = Good::new(15, variant).expect("the parameters are valid");
    let mut out = Vec::new();
    bencher.bench_local(|| {
        let frame = reference_frame(black_box(points)).expect("the object has many points");
        good.compute(points, &frame, &mut out)
    });
}

/// Axes, shape, size, colour and all axis hypotheses.
#[divan::bench(args = [false, true])]
fn appearance(bencher: Bencher<'_, '_>, is_upright: bool) {
    let (cloud, indices) = scene();
    let points = ObjectPoints::selected(&cloud, &indices).expect("the indices fit");
    let up = is_upright.then(nalgebra::Vector3::z_axis);
    let mut appearance =
        AppearanceDescriptor::new(AppearanceWeights::default()).expect("the weights are valid");
    bencher.bench_local(|| appearance.describe(black_box(points), up.as_ref()).is_ok());
}

#[divan::bench]
fn warped_good(bencher: Bencher<'_, '_>) {
    let (cloud, indices) = scene();
    let points = ObjectPoints::selected(&cloud, &indices).expect("the indices fit");
    let frame = frame_of(points);
    let (mut good, mut out) = (WarpedGood::new(), Vec::new());
    bencher.bench_local(|| good.compute(black_box(points), &frame, &mut out));
}
