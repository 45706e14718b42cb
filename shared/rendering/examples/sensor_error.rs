//! Measures the simulated sensor's depth noise beside the published law.
//!
//! `sensor_error OUT.csv`: one line for each distance (facing the plane) and
//! each angle (at 1.2 m): the kind of sweep, distance in metres, angle in
//! degrees, published and measured standard deviation in millimetres.

use geometry::{PinholeCamera, RigidTransform};
use mesh::{Surface, Triangle, TriangleMesh, Vertex};
use nalgebra::{Point3, UnitQuaternion, Vector3};
use point_cloud::Point;
use rendering::kinect::{AxialNoise, KinectSensor, SensorModel, Shot};
use rendering::{Error, Instance, PreparedMesh, Rasterizer};
use std::fmt::Write;

const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;
const N_FRAMES: u64 = 30;
/// Half a side of the block of pixels in the middle that is measured.
const HALF_BLOCK_PX: usize = 24;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(path) = std::env::args().nth(1) else {
        return Err("usage: sensor_error OUT.csv".into());
    };
    let mut table = String::from("sweep,z_m,angle_deg,published_mm,measured_mm\n");
    for i in 0..=30 {
        let z_m = 0.5 + 0.1 * i as f64;
        writeln!(table, "{}", line("distance", z_m, 0.0)?)?;
    }
    for angle_deg in (0..=75).step_by(3) {
        writeln!(table, "{}", line("angle", 1.2, f64::from(angle_deg))?)?;
    }
    std::fs::write(path, table)?;
    Ok(())
}

fn line(sweep: &str, z_m: f64, angle_deg: f64) -> Result<String, Error> {
    let published_m = AxialNoise::KINECT_V1.sigma_m(z_m as f32, angle_deg.to_radians() as f32);
    let measured_m = measured_sigma_m(z_m, angle_deg.to_radians())?;
    Ok(format!(
        "{sweep},{z_m:.2},{angle_deg:.0},{:.3},{:.3}",
        published_m * 1000.0,
        measured_m * 1000.0
    ))
}

/// Standard deviation of measured from exact depth around the image's centre.
fn measured_sigma_m(z_m: f64, angle_rad: f64) -> Result<f64, Error> {
    let mesh = PreparedMesh::new(&plane());
    let mut rasterizer = Rasterizer::new(CAMERA)?;
    let mut camera_from_plane = RigidTransform::translation(0.0, 0.0, z_m);
    // The plane looks along its z, which must point back at the camera.
    camera_from_plane.rotation =
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::PI - angle_rad);
    let image = rasterizer.render(&[Instance::new(&mesh, camera_from_plane, 1)]);
    let mut sensor = KinectSensor::new(CAMERA, SensorModel::KINECT_V1)?;
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for frame_index in 0..N_FRAMES {
        sensor.sense(
            image,
            Shot {
                seed: 1,
                frame_index,
            },
            &mut points,
        )?;
        for row in 240 - HALF_BLOCK_PX..240 + HALF_BLOCK_PX {
            for column in 320 - HALF_BLOCK_PX..320 + HALF_BLOCK_PX {
                let pixel = row * 640 + column;
                let error = f64::from(points[pixel].z) - f64::from(image.depth_m()[pixel]);
                if error.is_finite() {
                    n += 1.0;
                    sum += error;
                    squares += error * error;
                }
            }
        }
    }
    let mean: f64 = sum / n;
    Ok((squares / n - mean * mean).sqrt())
}

/// A large square around the origin that looks along z.
fn plane() -> TriangleMesh {
    let corner = |x: f32, y: f32| Vertex {
        position: Point3::new(x, y, 0.0),
        normal: Vector3::z(),
        color: [200; 3],
    };
    TriangleMesh {
        vertices: vec![
            corner(-20.0, -20.0),
            corner(20.0, -20.0),
            corner(20.0, 20.0),
            corner(-20.0, 20.0),
        ],
        triangles: [[0, 1, 2], [0, 2, 3]]
            .map(|vertices| Triangle {
                vertices,
                surface: 0,
            })
            .to_vec(),
        surfaces: vec![Surface::MATTE],
    }
}
