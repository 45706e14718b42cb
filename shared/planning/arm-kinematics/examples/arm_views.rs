//! Draws the arm from the side and from above, in its home pose and in three grasp poses.
//!
//! `cargo run -p arm-kinematics --example arm_views -- OUTPUT.png`

use arm_kinematics::{
    Arm, HOME, IkConfig, JointVector, LinkMeshes, inverse_kinematics, link_capsules,
};
use mesh::TriangleMesh;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::fs::File;
use std::io::BufWriter;

type AnyError = Box<dyn std::error::Error>;

const CELL_PX: usize = 480;
const PIXELS_PER_M: f64 = 420.0;

/// An orthographic picture with a depth buffer.
struct Picture {
    width_px: usize,
    colors: Vec<[u8; 3]>,
    depths: Vec<f64>,
}

/// Panel of the picture: its pixel corner and the direction of view.
struct ViewPanel {
    corner_px: [usize; 2],
    eye_from_base: UnitQuaternion<f64>,
    centre_in_base: Point3<f64>,
}

impl ViewPanel {
    /// Orthographic projection: pixel x, pixel y (down), height towards the eye.
    fn project(&self, point: &Point3<f64>) -> Vector3<f64> {
        let p = self.eye_from_base * (point - self.centre_in_base);
        let half = 0.5 * CELL_PX as f64;
        Vector3::new(half + PIXELS_PER_M * p.x, half - PIXELS_PER_M * p.y, p.z)
    }
}

impl Picture {
    fn new(width_px: usize, height_px: usize) -> Self {
        Self {
            width_px,
            colors: vec![[236, 240, 244]; width_px * height_px],
            depths: vec![f64::NEG_INFINITY; width_px * height_px],
        }
    }

    fn draw(&mut self, view: &ViewPanel, mesh: &TriangleMesh, base_from_body: &Isometry3<f64>) {
        let light = Vector3::new(-0.4, 0.5, 0.77);
        for triangle in &mesh.triangles {
            let corners = triangle.vertices.map(|i| mesh.vertices[i as usize]);
            let pixels = corners.map(|v| view.project(&(base_from_body * v.position.cast())));
            let normal: Vector3<f64> = corners.iter().map(|v| v.normal.cast::<f64>()).sum();
            let normal = view.eye_from_base * (base_from_body * normal.normalize());
            let shade = 0.35 + 0.65 * normal.dot(&light).max(0.0);
            let color = corners[0].color.map(|c| (f64::from(c) * shade) as u8);
            self.fill(view, &pixels, color);
        }
    }

    fn fill(&mut self, view: &ViewPanel, corners: &[Vector3<f64>; 3], color: [u8; 3]) {
        let [a, b, c] = corners;
        let area = (b - a).xy().perp(&(c - a).xy());
        if area.abs() < 1e-9 {
            return;
        }
        let end = CELL_PX as f64 - 1.0;
        let low = a.inf(b).inf(c).map(|x| x.floor().clamp(0.0, end) as usize);
        let high = a.sup(b).sup(c).map(|x| x.ceil().clamp(0.0, end) as usize);
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let p = nalgebra::Vector2::new(x as f64, y as f64);
                let u = (p - a.xy()).perp(&(c - a).xy()) / area;
                let v = (b - a).xy().perp(&(p - a.xy())) / area;
                let depth = a.z + u * (b.z - a.z) + v * (c.z - a.z);
                let i = (y + view.corner_px[1]) * self.width_px + x + view.corner_px[0];
                if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && depth > self.depths[i] {
                    self.depths[i] = depth;
                    self.colors[i] = color;
                }
            }
        }
    }

    /// Draws a red 3 x 3 dot over everything.
    fn mark(&mut self, view: &ViewPanel, point: &Point3<f64>) {
        let p = view.project(point);
        for (dx, dy) in (-1..=1).flat_map(|x| (-1..=1).map(move |y| (f64::from(x), f64::from(y)))) {
            let x = (p.x + dx).clamp(0.0, CELL_PX as f64 - 1.0) as usize + view.corner_px[0];
            let y = (p.y + dy).clamp(0.0, CELL_PX as f64 - 1.0) as usize + view.corner_px[1];
            self.colors[y * self.width_px + x] = [230, 60, 40];
        }
    }

    fn save(&self, path: &str) -> Result<(), AnyError> {
        let height_px = self.colors.len() / self.width_px;
        let file = BufWriter::new(File::create(path)?);
        let mut encoder = png::Encoder::new(file, self.width_px as u32, height_px as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder
            .write_header()?
            .write_image_data(self.colors.as_flattened())?;
        Ok(())
    }
}

/// Joint angles of four postures: home, straight down, level from the side, and far out.
fn postures(arm: &Arm) -> Result<[JointVector; 4], AnyError> {
    let home = JointVector::from(HOME);
    let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
    let down = about(Vector3::y_axis(), PI) * about(Vector3::z_axis(), FRAC_PI_2);
    let level = about(Vector3::y_axis(), FRAC_PI_2) * about(Vector3::z_axis(), FRAC_PI_2);
    let oblique = about(Vector3::z_axis(), 0.7) * about(Vector3::y_axis(), 2.4);
    let reach = |x, y, z, rotation| {
        let pose = Isometry3::from_parts([x, y, z].into(), rotation);
        inverse_kinematics(arm, &pose, &home, &IkConfig::default()).map(|found| found.joints_rad)
    };
    Ok([
        home,
        reach(0.45, 0.0, 0.05, down)?,
        reach(0.60, 0.10, 0.20, level)?,
        reach(0.50, 0.40, 0.10, oblique)?,
    ])
}

fn main() -> Result<(), AnyError> {
    let path = std::env::args()
        .nth(1)
        .ok_or("give the path of the picture")?;
    let arm = Arm::jaco_like();
    let meshes = LinkMeshes::new(&arm);
    let sideways = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -FRAC_PI_2);
    let oblique = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -1.0)
        * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -0.6);
    let mut picture = Picture::new(4 * CELL_PX, 2 * CELL_PX);
    for (column, joints) in postures(&arm)?.iter().enumerate() {
        for (row, eye_from_base) in [sideways, oblique].into_iter().enumerate() {
            let view = ViewPanel {
                corner_px: [column * CELL_PX, row * CELL_PX],
                eye_from_base,
                centre_in_base: Point3::new(0.2, 0.0, 0.4),
            };
            let poses = arm.body_poses(joints, 0.09);
            for (solid, pose) in meshes.links.iter().zip(&poses.base_from_link) {
                picture.draw(&view, &solid.mesh, pose);
            }
            picture.draw(&view, &meshes.rail.mesh, &poses.base_from_tool);
            for pose in &poses.base_from_finger {
                picture.draw(&view, &meshes.finger.mesh, pose);
            }
            picture.mark(&view, &poses.base_from_tool.translation.vector.into());
            for capsule in link_capsules(&arm, joints, 0.09) {
                picture.mark(&view, &capsule.from);
                picture.mark(&view, &capsule.to);
            }
        }
    }
    picture.save(&path)
}
