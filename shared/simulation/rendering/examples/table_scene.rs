//! Renders a table scene, exactly and as measured by the simulated Kinect.
//!
//! `table_scene FOLDER`: writes `exact_color`, `exact_depth`, `normals`, `instances`,
//! `kinect_color` and `kinect_depth` as PNG. The depth colours are red for near and blue for far;
//! missing depth is black.

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use geometry::PinholeCamera;
use point_cloud::Point;
use rendering::kinect::{FrameSeed, KinectSensor, SensorModel};
use rendering::{Lights, Rasterizer, StaticScene};
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use synthetic::TableScene;

const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;
/// Depths at the ends of the colour scale, metres.
const SCALE_M: [f32; 2] = [0.5, 2.5];

fn main() -> Result<(), Box<dyn Error>> {
    let Some(folder) = std::env::args().nth(1) else {
        return Err("usage: table_scene FOLDER".into());
    };
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let scene = TableScene::new(12);
    let mut rasterizer = Rasterizer::new(CAMERA)?;
    rasterizer.prepare(&StaticScene {
        world_from_camera: TableScene::world_from_camera(),
        lights: Lights::ROOM,
        background: &scene.background(),
    })?;
    let image = rasterizer.render(&scene.objects());

    save(
        folder,
        "exact_depth",
        image.depth_m().iter().map(|&z| depth_color(z)),
    )?;
    save(
        folder,
        "normals",
        image
            .reflection()
            .iter()
            .map(|reflection| reflection.normal.map(|part| (i16::from(part) + 128) as u8)),
    )?;
    save(
        folder,
        "instances",
        image.instance().iter().map(|&id| id_color(id)),
    )?;

    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    for (name, model) in [
        ("exact", SensorModel::PERFECT),
        ("kinect", SensorModel::KINECT_V1),
    ] {
        let mut sensor = KinectSensor::new(CAMERA, model)?;
        sensor.sense(image, FrameSeed::default(), &mut points)?;
        save(
            folder,
            &format!("{name}_color"),
            sensor.color().iter().copied(),
        )?;
        let depth_m = sensor.depth_mm().iter().map(|&mm| f32::from(mm) / 1000.0);
        save(folder, &format!("{name}_depth"), depth_m.map(depth_color))?;
    }
    Ok(())
}

fn depth_color(depth_m: f32) -> [u8; 3] {
    if !(depth_m > 0.0 && depth_m.is_finite()) {
        return [0; 3];
    }
    let t = ((depth_m - SCALE_M[0]) / (SCALE_M[1] - SCALE_M[0])).clamp(0.0, 1.0);
    let hat = |center: f32| (255.0 * (1.6 - 4.0 * (t - center).abs()).clamp(0.0, 1.0)) as u8;
    [hat(0.1), hat(0.45), hat(0.85)]
}

fn id_color(id: u16) -> [u8; 3] {
    let hash = u32::from(id).wrapping_mul(0x9e37_79b1);
    if id == 0 {
        [0; 3]
    } else {
        [hash >> 24, hash >> 16, hash >> 8].map(|part| part as u8 | 0x30)
    }
}

fn save(
    folder: &Path,
    name: &str,
    pixels: impl Iterator<Item = [u8; 3]>,
) -> Result<(), Box<dyn Error>> {
    let file = File::create(folder.join(name).with_extension("png"))?;
    let mut encoder = png::Encoder::new(BufWriter::new(file), CAMERA.width, CAMERA.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let bytes: Vec<u8> = pixels.flatten().collect();
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(())
}
