//! Contact sheet: draws some instances of each category to PNG pages.
//!
//! `cargo run -p household --example contact_sheet -- FOLDER [INSTANCES] [ROWS]`
//!
//! Each cell is scaled to its object; the bar at the bottom is 5 cm long.
#![allow(clippy::print_stdout)]

use household::{Object, categories, generate};
use nalgebra::{Point3, Rotation3, Vector3};
use std::f32::consts::FRAC_PI_2;
use std::{error::Error, fs::File, io::BufWriter, path::Path};

const CELL_PX: usize = 210;
const N_COLUMNS: usize = 2;
const BACKGROUND: [u8; 3] = [250, 250, 250];

struct Picture {
    width: usize,
    height: usize,
    colors: Vec<[u8; 3]>,
    depths: Vec<f32>,
}

impl Picture {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            colors: vec![BACKGROUND; width * height],
            depths: vec![f32::NEG_INFINITY; width * height],
        }
    }

    fn set(&mut self, x: usize, y: usize, depth: f32, color: [u8; 3]) {
        if x < self.width && y < self.height && depth > self.depths[y * self.width + x] {
            self.depths[y * self.width + x] = depth;
            self.colors[y * self.width + x] = color;
        }
    }

    fn save(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let file = BufWriter::new(File::create(path)?);
        let mut encoder = png::Encoder::new(file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let bytes: Vec<u8> = self.colors.iter().flatten().copied().collect();
        encoder.write_header()?.write_image_data(&bytes)?;
        Ok(())
    }
}

/// Rotation from the object's frame to the view frame: x right, y up, z towards the eye, which
/// looks down from 35° above the table.
fn view_from_object() -> Rotation3<f32> {
    let elevation_rad = 35.0_f32.to_radians();
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.6);
    Rotation3::from_axis_angle(&Vector3::x_axis(), elevation_rad - FRAC_PI_2) * turn
}

fn draw(picture: &mut Picture, object: &Object, left: usize, top: usize) {
    let view_from_object = view_from_object();
    let seen = |p: Point3<f32>| view_from_object * p;
    let points: Vec<Point3<f32>> = object
        .mesh
        .vertices
        .iter()
        .map(|v| seen(v.position))
        .collect();
    let Some(bounds) = mesh::Bounds::of(points.iter().copied()) else {
        return;
    };
    let sides = bounds.sides();
    let px_per_m = (CELL_PX as f32 * 0.88) / sides.x.max(sides.y).max(0.05);
    let middle = Vector3::new(left as f32, top as f32, 0.0).add_scalar(CELL_PX as f32 / 2.0);
    let light = Vector3::new(-0.5, 0.6, 0.8).normalize();
    for triangle in &object.mesh.triangles {
        let corners = triangle.vertices.map(|i| {
            let offset = (points[i as usize] - bounds.centre()) * px_per_m;
            Vector3::new(offset.x, -offset.y, offset.z) + middle
        });
        let vertices = triangle.vertices.map(|i| object.mesh.vertices[i as usize]);
        let shaded = vertices.map(|vertex| {
            let lambert = (view_from_object * vertex.normal).dot(&light).max(0.0);
            Vector3::from(vertex.color.map(f32::from)) * (0.38 + 0.62 * lambert)
        });
        fill(picture, corners, shaded);
    }
    for x in 0..(0.05 * px_per_m) as usize {
        picture.set(left + 8 + x, top + CELL_PX - 5, 1e6, [120, 120, 120]);
    }
}

fn fill(picture: &mut Picture, corners: [Vector3<f32>; 3], colors: [Vector3<f32>; 3]) {
    let [a, b, c] = corners;
    let area = (b - a).xy().perp(&(c - a).xy());
    if area.abs() < 1e-6 {
        return;
    }
    let low = a.inf(&b).inf(&c).map(|x| x.max(0.0) as usize);
    let high = a.sup(&b).sup(&c).map(|x| x.max(0.0) as usize + 1);
    for y in low.y..=high.y {
        for x in low.x..=high.x {
            let p = Vector3::new(x as f32 + 0.5, y as f32 + 0.5, 0.0);
            let w0 = (b - p).xy().perp(&(c - p).xy()) / area;
            let w1 = (c - p).xy().perp(&(a - p).xy()) / area;
            let w2 = 1.0 - w0 - w1;
            if w0 >= 0.0 && w1 >= 0.0 && w2 >= 0.0 {
                let depth = a.z * w0 + b.z * w1 + c.z * w2;
                let color = colors[0] * w0 + colors[1] * w1 + colors[2] * w2;
                picture.set(x, y, depth, [color.x, color.y, color.z].map(|c| c as u8));
            }
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("name a folder for the pages")?;
    let n_instances: usize = arguments.next().map_or(Ok(4), |n| n.parse())?;
    let n_rows: usize = arguments.next().map_or(Ok(5), |n| n.parse())?;
    std::fs::create_dir_all(&folder)?;
    for (page, on_page) in categories().chunks(n_rows * N_COLUMNS).enumerate() {
        let width = N_COLUMNS * n_instances * CELL_PX;
        let mut picture = Picture::new(width, n_rows * CELL_PX);
        for (i, category) in on_page.iter().enumerate() {
            let (row, column) = (i / N_COLUMNS, i % N_COLUMNS);
            for instance in 0..n_instances {
                let object = generate(category, instance as u64);
                let left = (column * n_instances + instance) * CELL_PX;
                draw(&mut picture, &object, left, row * CELL_PX);
            }
        }
        let path = Path::new(&folder).join(format!("page-{page:02}.png"));
        picture.save(&path)?;
        let names: Vec<&str> = on_page.iter().map(|category| category.name).collect();
        println!("{}: {}", path.display(), names.join(", "));
    }
    Ok(())
}
