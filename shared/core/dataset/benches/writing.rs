//! Writing of one frame of 640x480 pixels of an RGB-D sequence.
//!
//! `cargo bench -p dataset --bench writing`. A real frame is used when the
//! development data is available (see `TABULA_DATA`), a synthetic one always.

use dataset::rgbd_sequence::{FrameView, RgbdSequence, Scratch, SequenceWriter};
use divan::Bencher;
use geometry::{PinholeCamera, RigidTransform};
use point_cloud::Point;

const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;

fn main() {
    divan::main();
}

/// Colour image, depth image and instance mask.
struct Images {
    color: Vec<u8>,
    depth_mm: Vec<u16>,
    instances: Vec<u16>,
}

/// Synthetic frame: a checkered wall that leans back.
fn synthetic() -> Images {
    let pixels = || (0..CAMERA.n_pixels()).map(|pixel| (pixel % 640, pixel / 640));
    let field = |(column, row): (usize, usize)| (column / 80 + row / 60) % 3;
    let shade = |(column, row)| (60 * field((column, row)) + (column + row) / 10) as u8;
    Images {
        color: pixels()
            .flat_map(|pixel| [shade(pixel), 90, 255 - shade(pixel)])
            .collect(),
        depth_mm: pixels()
            .map(|(column, row)| (900 + column / 7 + 2 * row) as u16)
            .collect(),
        instances: pixels().map(|pixel| field(pixel) as u16).collect(),
    }
}

/// Middle frame of a real sequence, if available.
fn real() -> Option<Images> {
    let sequence = RgbdSequence::open(&test_data::find("kitchen-sequence")?).ok()?;
    let mut points = vec![Point::default(); sequence.camera().n_pixels()];
    let middle = sequence.n_frames() / 2;
    sequence
        .fill(middle, &mut Scratch::default(), &mut points)
        .ok()?;
    Some(Images {
        color: points.iter().flat_map(|point| point.color.rgb()).collect(),
        depth_mm: points
            .iter()
            .map(|point| (1000.0 * point.z).round() as u16)
            .collect(),
        ..synthetic()
    })
}

fn frames() -> Vec<&'static str> {
    let real = real().map(|_| "real");
    ["synthetic"].into_iter().chain(real).collect()
}

/// Complete frame: three images and a pose.
#[divan::bench(args = frames(), sample_count = 50, sample_size = 1)]
fn write_frame(bencher: Bencher, name: &str) {
    let images = if name == "real" { real() } else { None }.unwrap_or_else(synthetic);
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut writer = SequenceWriter::create(folder.path(), &CAMERA, None).expect("it is empty");
    let frame = FrameView {
        color: &images.color,
        depth_mm: &images.depth_mm,
        instances: Some(&images.instances),
        world_from_camera: Some(RigidTransform::identity()),
        truth: None,
    };
    bencher.bench_local(|| writer.write(&frame).expect("the frame is valid"));
}
