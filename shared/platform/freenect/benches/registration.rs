//! Benchmark of depth-to-colour registration: one cloud from a pair of Kinect images.

use divan::Bencher;
use freenect::{Calibration, CloudBuilder, N_PIXELS};
use point_cloud::Point;

fn main() {
    divan::main();
}

/// Depth image of a slanted table with holes: raw values of about 0.6 m to 1.5 m.
fn depth_image() -> Vec<u16> {
    let raw = |i: usize| {
        if i.is_multiple_of(17) {
            2047
        } else {
            520 + (i / 640 * 3 / 4) as u16
        }
    };
    (0..N_PIXELS).map(raw).collect()
}

#[divan::bench]
fn fill_cloud(bencher: Bencher) {
    let builder = CloudBuilder::new(&Calibration::nominal()).expect("the nominal values are valid");
    let (depth, rgb) = (depth_image(), vec![77; 3 * N_PIXELS]);
    let mut cloud = vec![Point::default(); N_PIXELS];
    bencher.bench_local(|| builder.fill(&depth, &rgb, &mut cloud));
}
