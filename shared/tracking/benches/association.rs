//! Association and motion filter of a full table.

use divan::{Bencher, black_box};
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Point3, Vector3};
use tracking::{
    Appearance, AssociationBuffers, AssociationConfig, Measurement, MotionConfig, MotionFilter,
    Observed, Predicted, associate,
};

fn main() {
    divan::main();
}

#[divan::bench(args = [5, 20, 80])]
fn associate_all(bencher: Bencher<'_, '_>, n: usize) {
    let appearance = Appearance {
        volume_m3: 1e-3,
        mean_rgb: [90.0; 3],
        is_cut: false,
    };
    let place = |i: usize| Point3::new(0.02 * i as f64, 0.003 * (i % 7) as f64, 0.0);
    let tracks: Vec<_> = (0..n)
        .map(|i| Predicted {
            position: place(i),
            position_variance_m2: 1e-4,
            appearance,
        })
        .collect();
    let candidates: Vec<_> = (0..n)
        .map(|i| Observed {
            position: place(n - 1 - i),
            position_variance_m2: 1e-5,
            appearance,
        })
        .collect();
    let (config, mut buffers) = (AssociationConfig::default(), AssociationBuffers::default());
    bencher.bench_local(|| {
        associate(black_box(&tracks), &candidates, &config, &mut buffers)
            .iter()
            .flatten()
            .count()
    });
}

#[divan::bench]
fn update_filter(bencher: Bencher<'_, '_>) {
    let config = MotionConfig::default();
    let shape = OrientedBox {
        frame_from_box: RigidTransform::new(Vector3::new(0.1, 0.2, 0.9), Vector3::z() * 0.3),
        half_sides_m: Vector3::new(0.05, 0.04, 0.1),
    };
    let seen = |stamp_ns| Measurement::new(stamp_ns, shape, 0.9, false);
    let (Ok(first), Ok(second)) = (seen(0), seen(33_000_000)) else {
        return;
    };
    let filter = MotionFilter::start(&first, &config);
    bencher.bench_local(|| black_box(&filter).updated(black_box(&second), &config));
}
