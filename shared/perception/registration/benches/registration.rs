//! Benchmark of registration: two views of a box from far off, by their number of points.

use divan::{Bencher, black_box};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use random::Random;
use registration::{PoseModel, Prior, SegmentView, ViewSurface, estimate_pose, register};
use sensor_noise::DepthNoise;

fn main() {
    divan::main();
}

/// Points on the three visible faces of a box with sides of 12, 8 and 5 cm, moved.
fn view(n_points: usize, seed: u64, moved: &Isometry3<f64>) -> Vec<[f32; 3]> {
    let half = Vector3::new(0.06, 0.04, 0.025);
    let mut random = Random::from_seed(seed);
    let mut point = || {
        let mut place = half.map(|half| half * random.between(-1.0, 1.0));
        let axis = random.below(3);
        place[axis] = half[axis] + 0.0005 * random.normal();
        (moved * Point3::from(place)).cast::<f32>().into()
    };
    (0..n_points).map(|_| point()).collect()
}

fn far_off() -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_scaled_axis(Vector3::new(0.15, -0.1, 0.2));
    Isometry3::from_parts(Translation3::new(0.02, -0.015, 0.01), rotation)
}

/// Surface of a view: surfels, search tree and range image.
#[divan::bench(args = [2500, 10_000, 40_000])]
fn surface(bencher: Bencher<'_, '_>, n_points: usize) {
    let points = view(n_points, 1, &Isometry3::identity());
    bencher.bench_local(|| ViewSurface::new(black_box(&points), None));
}

/// Registration of two surfaces.
#[divan::bench(args = [2500, 10_000, 40_000])]
fn registration(bencher: Bencher<'_, '_>, n_points: usize) {
    let target = ViewSurface::new(&view(n_points, 1, &Isometry3::identity()), None);
    let source = ViewSurface::new(&view(n_points, 2, &far_off()), None);
    let prior = Prior::at(Isometry3::identity());
    bencher.bench_local(|| {
        let (target, source) = (target.as_ref().ok()?, source.as_ref().ok()?);
        register(black_box(target), black_box(source), &prior).ok()
    });
}

/// Whole surface of the box, 3 mm between points.
fn whole_box() -> Vec<[f32; 3]> {
    let mut random = Random::from_seed(3);
    let half = Vector3::new(0.06, 0.04, 0.025);
    let mut point = || {
        let mut place = half.map(|half| half * random.between(-1.0, 1.0));
        let axis = random.below(3);
        place[axis] = place[axis].signum() * half[axis];
        place.cast::<f32>().into()
    };
    (0..6000).map(|_| point()).collect()
}

/// Templates and search tree of a model.
#[divan::bench]
fn pose_model(bencher: Bencher<'_, '_>) {
    let points = whole_box();
    bencher.bench_local(|| PoseModel::new(black_box(&points), 0.003));
}

/// Pose of a model in a segment of 5000 points, in any orientation.
#[divan::bench]
fn model_pose(bencher: Bencher<'_, '_>) {
    let moved = Translation3::new(0.0, 0.0, 0.9) * far_off();
    let segment = view(5000, 1, &moved);
    let model = PoseModel::new(&whole_box(), 0.003);
    let view = SegmentView::new(&segment, &segment, DepthNoise::KINECT_V1);
    bencher.bench_local(|| {
        let (model, view) = (model.as_ref().ok()?, view.as_ref().ok()?);
        estimate_pose(black_box(model), black_box(view)).ok()
    });
}
