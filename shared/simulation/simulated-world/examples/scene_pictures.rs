//! Draws a generated scene: `scene_pictures KIND SEED FOLDER [SECONDS]` writes colour, depth,
//! normals and mask of the simulated Kinect's view.

#![allow(clippy::print_stdout, reason = "an example prints its results")]
use geometry::PinholeCamera;
use point_cloud::Point;
use simulated_world::{ModelLibrary, Scene, SceneKind, SimulatedKinect, World};
use std::error::Error;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [kind, seed, folder, rest @ ..] = arguments.as_slice() else {
        return Err("usage: scene_pictures everyday|KIND|FILE.toml SEED FOLDER [SECONDS]".into());
    };
    let seed = seed.parse()?;
    let seconds: f64 = rest.first().map_or(Ok(0.0), |text| text.parse())?;
    let started = std::time::Instant::now();
    let mut library = ModelLibrary::generated();
    let (scene, library) = if Path::new(kind).exists() {
        Scene::open(Path::new(kind), Some(seed))?
    } else if kind == "everyday" {
        (Scene::everyday(5, seed, &mut library)?, library)
    } else {
        let kind: SceneKind = kind.parse()?;
        let scene = Scene::generate(kind, kind.default_n_objects(), seed, &mut library)?;
        (scene, library)
    };
    let mut world = World::new(scene, library)?;
    println!("set up in {:.2?}", started.elapsed());
    while world.time_s() < seconds {
        world.step();
    }
    for note in world.take_notes() {
        println!("{note}");
    }
    let camera = PinholeCamera::KINECT_V1;
    let mut kinect = SimulatedKinect::new(&world, camera)?;
    let mut points = vec![Point::default(); camera.n_pixels()];
    kinect.look(&world, 0, &mut points)?;
    let started = std::time::Instant::now();
    let truth = kinect.look(&world, 1, &mut points)?;
    println!("looked in {:.2?}", started.elapsed());
    for object in &truth {
        let fraction = object.visible_fraction();
        println!(
            "{:3} {:20} {fraction:.2} {}",
            object.id,
            object.name,
            object.state.word()
        );
    }
    std::fs::create_dir_all(folder)?;
    let name = |what: &str| PathBuf::from(folder).join(format!("{what}.png"));
    write(&name("color"), &camera, |i| points[i].color.rgb())?;
    write(&name("depth"), &camera, |i| depth_color(points[i].z))?;
    let reflection = kinect.image().reflection();
    write(&name("normals"), &camera, |i| {
        reflection[i].normal.map(|v| (i16::from(v) + 128) as u8)
    })?;
    write(&name("mask"), &camera, |i| mask_color(kinect.mask()[i]))?;
    Ok(())
}

fn write(
    path: &Path,
    camera: &PinholeCamera,
    pixel: impl Fn(usize) -> [u8; 3],
) -> Result<(), Box<dyn Error>> {
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    let mut encoder = png::Encoder::new(file, camera.width, camera.height);
    encoder.set_color(png::ColorType::Rgb);
    let pixels: Vec<u8> = (0..camera.n_pixels()).flat_map(pixel).collect();
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(())
}

/// Depth colour scale: near is red, far is blue, missing depth is black.
fn depth_color(z_m: f32) -> [u8; 3] {
    if !z_m.is_finite() {
        return [0; 3];
    }
    let share = ((z_m - 0.5) / 2.0).clamp(0.0, 1.0);
    let band = (z_m * 20.0).fract() * 60.0;
    [
        (255.0 * (1.0 - share)) as u8,
        (120.0 + band) as u8,
        (255.0 * share) as u8,
    ]
}

fn mask_color(id: u16) -> [u8; 3] {
    if id == 0 {
        return [0; 3];
    }
    let hash = u32::from(id).wrapping_mul(2_654_435_761);
    [
        (hash >> 24) as u8 | 64,
        (hash >> 16) as u8 | 64,
        (hash >> 8) as u8 | 64,
    ]
}
