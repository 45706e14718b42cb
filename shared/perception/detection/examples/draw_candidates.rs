//! Overlay of detected candidates on the image, two pictures side by side.
//!
//! `draw_candidates SCENE.pcd OUT.png`: candidates on the left, labels on the right.
//! `draw_candidates FOLDER FRAME OUT.png`: one frame of an RGB-D sequence, without gravity
//! on the left, with gravity on the right.
//!
//! Candidates are coloured, the table is tinted green, pixels without depth are dark.

use dataset::pcd;
use dataset::rgbd_sequence::{RgbdSequence, Scratch};
use detection::{Config, Detection, DetectionInput, Execution, ScenePriors, Workspace, detect};
use nalgebra::{Unit, Vector3};
use point_cloud::{OrganizedCloud, Point};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;

/// First segment number of a candidate; 1 is the table, 0 is background.
const FIRST_OBJECT: u32 = 10;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [scene, out] => draw_scene(scene, out),
        [folder, frame, out] => draw_frame(folder, frame.parse()?, out),
        _ => Err("usage: draw_candidates SCENE.pcd OUT.png | FOLDER FRAME OUT.png".into()),
    }
}

fn draw_scene(scene: &str, out: &str) -> Result<(), Box<dyn Error>> {
    let scene = pcd::open(scene.as_ref())?;
    let cloud = OrganizedCloud::new(&scene.points, scene.width, scene.height)?;
    let found = segments(&cloud, None)?;
    let labels = scene.labels.as_ref().unwrap_or(&found);
    save(out, &cloud, [&found, labels])
}

fn draw_frame(folder: &str, index: usize, out: &str) -> Result<(), Box<dyn Error>> {
    let sequence = RgbdSequence::open(folder.as_ref())?;
    let mut points = vec![Point::default(); sequence.camera().n_pixels()];
    let pose = sequence.fill(index, &mut Scratch::default(), &mut points)?;
    let size = (
        sequence.camera().width as usize,
        sequence.camera().height as usize,
    );
    let cloud = OrganizedCloud::new(&points, size.0, size.1)?;
    let up = pose
        .zip(sequence.gravity_in_world())
        .map(|(world_from_camera, gravity)| {
            Unit::new_normalize(world_from_camera.rotation.inverse() * -gravity.into_inner())
        });
    save(
        out,
        &cloud,
        [&segments(&cloud, None)?, &segments(&cloud, up)?],
    )
}

/// Segment number of each pixel.
fn segments(
    cloud: &OrganizedCloud<'_>,
    up_in_camera: Option<Unit<Vector3<f64>>>,
) -> Result<Vec<u32>, Box<dyn Error>> {
    let frame = DetectionInput {
        cloud: *cloud,
        up_in_camera,
        priors: ScenePriors::default(),
    };
    let mut detection = Detection::default();
    detect(
        &frame,
        &Config::default(),
        &mut Workspace::default(),
        &mut detection,
        Execution::default(),
    )?;
    let mut segment_of = vec![0; cloud.points().len()];
    if let Some(table) = detection.table() {
        for (segment, point) in segment_of.iter_mut().zip(cloud.points()) {
            let p = table.table_from_camera * point.position();
            *segment = u32::from(p.z.abs() < 0.01 && table.polygon.contains(&p.xy()));
        }
    }
    let hypotheses = detection
        .candidates
        .iter()
        .filter(|candidate| candidate.is_hypothesis());
    for (number, candidate) in (FIRST_OBJECT..).zip(hypotheses) {
        for &pixel in detection.points_of(candidate) {
            segment_of[pixel as usize] = number;
        }
    }
    Ok(segment_of)
}

/// Colour of a pixel, tinted by its segment.
fn painted(point: &Point, segment: u32) -> [u8; 3] {
    let [red, green, blue] = point.color.rgb();
    if segment < FIRST_OBJECT {
        return match (point.is_finite(), segment) {
            (false, _) => [red / 3, green / 3, blue / 3],
            (true, 0) => [red, green, blue],
            (true, _) => [red / 2, green / 2 + 100, blue / 2],
        };
    }
    let hash = segment.wrapping_mul(0x9e37_79b1);
    let tint = [hash >> 24, hash >> 16, hash >> 8].map(|value| value as u8 | 0x40);
    [
        red / 3 + tint[0] / 3 * 2,
        green / 3 + tint[1] / 3 * 2,
        blue / 3 + tint[2] / 3 * 2,
    ]
}

fn save(path: &str, cloud: &OrganizedCloud<'_>, sides: [&[u32]; 2]) -> Result<(), Box<dyn Error>> {
    let (width, height) = (cloud.width(), cloud.height());
    let mut image = Vec::with_capacity(6 * width * height);
    for row in 0..height {
        for segment_of in sides {
            let pixels = row * width..(row + 1) * width;
            image.extend(pixels.flat_map(|i| painted(&cloud.points()[i], segment_of[i])));
        }
    }
    let file = BufWriter::new(File::create(path)?);
    let mut encoder = png::Encoder::new(file, 2 * width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(&image)?;
    Ok(())
}
