//! Decoding of one image of 640x480 points into preallocated memory.
//!
//! `cargo bench -p dataset`. The real scenes are used when the development data
//! is available (see `TABULA_DATA`), a synthetic one always.

use dataset::{pcd, rgbd_sequence};
use divan::Bencher;
use geometry::{PinholeCamera, RigidTransform};
use point_cloud::{Point, Rgba};

fn main() {
    divan::main();
}

/// Pseudorandom values, for noise that cannot be compressed.
fn noise(seed: usize) -> u32 {
    (seed as u32)
        .wrapping_mul(0x9e37_79b1)
        .rotate_left(13)
        .wrapping_mul(0x85eb_ca6b)
}

/// Synthetic scene: a frontal wall with the Kinect's depth quantisation, noisy colours and one
/// pixel in eight without depth.
fn synthetic_scene() -> Vec<u8> {
    let camera = PinholeCamera::KINECT_V1;
    let points: Vec<Point> = (0..camera.n_pixels())
        .map(|pixel| {
            let (column, row) = (pixel % 640, pixel / 640);
            let color = Rgba(0xff80_8080 | noise(pixel) >> 29);
            if (column / 40 + row / 30) % 8 == 0 {
                return Point::without_depth(color);
            }
            let z_m = 1.0 + f64::from(noise(pixel) % 3) * 0.003;
            let point = camera.back_project(column as f64, row as f64, z_m);
            Point {
                x: point.x as f32,
                y: point.y as f32,
                z: point.z as f32,
                color,
            }
        })
        .collect();
    let view = pcd::PcdView {
        points: &points,
        labels: None,
        width: 640,
        height: 480,
        viewpoint: RigidTransform::identity(),
    };
    pcd::write(view, pcd::Encoding::BinaryCompressed).expect("a full grid can be written")
}

fn bench_pcd(bencher: Bencher, file: &[u8]) {
    let mut decoder = pcd::Decoder::new();
    let mut points = vec![Point::default(); 640 * 480];
    bencher.bench_local(|| {
        let header = pcd::Header::parse(file).expect("the file is valid");
        decoder
            .decode_into(file, &header, &mut points, None)
            .expect("the file is valid");
    });
}

#[divan::bench]
fn pcd_binary_compressed_synthetic(bencher: Bencher) {
    bench_pcd(bencher, &synthetic_scene());
}

fn real_scenes() -> Vec<&'static str> {
    let mut scenes = vec!["learn0.pcd", "learn20.pcd", "learn33.pcd"];
    scenes.retain(|name| test_data::find(&format!("tabletop-scenes/{name}")).is_some());
    scenes
}

#[divan::bench(args = real_scenes())]
fn pcd_binary_compressed(bencher: Bencher, name: &str) {
    let path = test_data::path(&format!("tabletop-scenes/{name}"));
    bench_pcd(
        bencher,
        &std::fs::read(path).expect("the scene is readable"),
    );
}

/// Back-projection of decoded images to points.
#[divan::bench]
fn back_projection(bencher: Bencher) {
    let camera = PinholeCamera::KINECT_V1;
    let projection = rgbd_sequence::BackProjection::new(&camera);
    let depth_mm: Vec<u16> = (0..camera.n_pixels())
        .map(|pixel| (noise(pixel) % 4 * (pixel as u32 % 2000)) as u16)
        .collect();
    let color: Vec<u8> = (0..3 * camera.n_pixels())
        .map(|value| noise(value) as u8)
        .collect();
    let mut points = vec![Point::default(); camera.n_pixels()];
    bencher.bench_local(|| {
        projection
            .fill(&depth_mm, &color, &mut points)
            .expect("the slices fill the image");
    });
}

fn real_sequences() -> Vec<&'static str> {
    let mut sequences = vec!["kitchen-sequence"];
    sequences.retain(|name| test_data::find(name).is_some());
    sequences
}

/// Complete frame: three files, both images, points.
#[divan::bench(args = real_sequences())]
fn rgbd_frame(bencher: Bencher, name: &str) {
    let sequence = rgbd_sequence::RgbdSequence::open(&test_data::path(name));
    let sequence = sequence.expect("the sequence is valid");
    let mut scratch = rgbd_sequence::Scratch::default();
    let mut points = vec![Point::default(); sequence.camera().n_pixels()];
    let mut index = 0;
    bencher.bench_local(|| {
        index = (index + 1) % sequence.n_frames();
        sequence
            .fill(index, &mut scratch, &mut points)
            .expect("the frame is valid");
    });
}
