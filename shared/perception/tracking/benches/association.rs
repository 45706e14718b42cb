//! Benchmark of data association and motion filter for a full table.

use divan::{Bencher, black_box};
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Matrix3, Vector3};
use point_cloud::{ColorHistogram, Rgba};
use sensor_noise::DepthNoise;
use tracking::{
    AssociationBuffers, AssociationConfig, CoarseAppearance, HandContact, Measurement,
    MotionConfig, MotionFilter, ObservedCandidate, PredictedTrack, ViewingConditions, associate,
};

fn main() {
    divan::main();
}

#[divan::bench(args = [5, 20, 80, 200])]
fn associate_all(bencher: Bencher<'_, '_>, n: usize) {
    let appearance = CoarseAppearance {
        volume_m3: 1e-3,
        colors: ColorHistogram::from_colors([Rgba::opaque(90, 90, 90)]),
        is_truncated: false,
    };
    let box_of = |i: usize| OrientedBox {
        frame_from_box: RigidTransform::translation(0.02 * i as f64, 0.003 * (i % 7) as f64, 0.0),
        half_sides_m: Vector3::repeat(0.05),
    };
    let tracks: Vec<_> = (0..n)
        .map(|i| PredictedTrack {
            box_in_world: box_of(i),
            covariance_m2: Matrix3::identity() * 1e-4,
            appearance,
        })
        .collect();
    let candidates: Vec<_> = (0..n)
        .map(|i| ObservedCandidate {
            box_in_world: box_of(n - 1 - i),
            position_variance_m2: 1e-5,
            appearance,
            overlaps_body: false,
        })
        .collect();
    let (config, mut buffers) = (AssociationConfig::default(), AssociationBuffers::default());
    bencher.bench_local(|| {
        let tracks = black_box(&tracks).iter().copied().map(Some);
        let candidates = candidates.iter().copied().map(Some);
        associate(tracks, candidates, &config, &mut buffers)
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
    let conditions = ViewingConditions {
        depth_m: 0.9,
        depth_noise: DepthNoise::KINECT_V1,
        ray_in_world: Vector3::y_axis(),
        variances_m2: Vector3::new(8e-4, 5e-4, 3e-3),
        stands_on_table: true,
        is_truncated: false,
        hand_contact: HandContact::None,
    };
    let seen = |stamp_ns| Measurement::new(stamp_ns, shape, conditions);
    let (Ok(first), Ok(second)) = (seen(0), seen(33_000_000)) else {
        return;
    };
    let filter = MotionFilter::start(&first, &config);
    bencher.bench_local(|| black_box(&filter).updated(black_box(&second), None, &config));
}
