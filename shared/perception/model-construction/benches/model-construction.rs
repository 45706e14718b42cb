//! Benchmark of model construction: a view of about 10 000 points joins a model.

#[path = "../src/test_object.rs"]
mod test_object;

use divan::Bencher;
use model_construction::{Config, ModelBuilder, PoseSigma};
use random::Random;
use test_object::{TestObject, disturbed, view, world_from_camera};

const SIGMA: PoseSigma = PoseSigma {
    rotation_rad: 0.05,
    translation_m: 0.01,
};

/// Angle between two views, degrees.
const STEP_DEG: f64 = 10.0;

fn main() {
    divan::main();
}

/// Model of the first views of an orbit.
fn model(object: TestObject, n_views: u64, random: &mut Random) -> ModelBuilder {
    let mut builder = ModelBuilder::new(Config::default());
    for index in 0..n_views {
        add(&mut builder, object, index, random);
    }
    builder
}

fn add(builder: &mut ModelBuilder, object: TestObject, index: u64, random: &mut Random) {
    let pose = world_from_camera(STEP_DEG * index as f64, 40.0);
    let points = object.points(&pose, index);
    let reported = disturbed(&pose, &SIGMA, random);
    // A refused view takes as long.
    let _ = builder.add(&view(&points, reported, SIGMA, index));
}

/// Registration and fusion of one view.
#[divan::bench(args = [TestObject::BoxWithBall, TestObject::Ball])]
fn one_view(bencher: Bencher<'_, '_>, object: TestObject) {
    let pose = world_from_camera(STEP_DEG * 12.0, 40.0);
    let points = object.points(&pose, 100);
    bencher
        .counter(divan::counter::ItemsCount::new(points.len()))
        .with_inputs(|| {
            let mut random = Random::from_seed(1);
            let builder = model(object, 12, &mut random);
            (builder, disturbed(&pose, &SIGMA, &mut random))
        })
        .bench_local_values(|(mut builder, reported)| {
            let added = builder.add(&view(&points, reported, SIGMA, 12)).is_ok();
            (builder, added)
        });
}

/// Marching cubes over the model of a whole orbit.
#[divan::bench]
fn mesh(bencher: Bencher<'_, '_>) {
    let builder = model(TestObject::BoxWithBall, 36, &mut Random::from_seed(2));
    bencher.bench_local(|| builder.mesh());
}
