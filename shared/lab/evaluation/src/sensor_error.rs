//! Depth noise of the simulated Kinect against the published axial noise model.
//!
//! A plane is rendered from 0.5 to 3.5 m, and at 1.2 m with a tilt of up to 75 degrees; the
//! standard deviation of its depth is compared with the axial noise that Nguyen, Izadi and Lovell
//! (2012) measured for the Kinect v1.

use geometry::{PinholeCamera, RigidTransform};
use mesh::{Surface, Triangle, TriangleMesh, Vertex};
use nalgebra::{Point3, UnitQuaternion, Vector3};
use plot::diagram::{Axis, Color, Curve, Diagram, DrawingError, Legend, side_by_side};
use point_cloud::Point;
use rendering::kinect::{AxialNoise, FrameSeed, KinectSensor, SensorModel};
use rendering::{Error, Instance, PreparedMesh, Rasterizer};
use std::fmt::Write;

const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;
/// Number of frames per placement of the plane.
const N_FRAMES: u64 = 30;
/// Half the side of the evaluated block of central pixels.
const HALF_BLOCK_PX: usize = 24;
/// Distance at which the plane is tilted, metres.
const TILTED_AT_M: f64 = 1.2;

/// Depth noise at one placement of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthNoise {
    /// Distance of the plane along the optical axis, metres.
    pub z_m: f64,
    /// Angle between the plane's normal and the optical axis, degrees.
    pub angle_deg: f64,
    /// Standard deviation of the published model, metres.
    pub published_m: f64,
    /// Standard deviation of the simulated depth, metres.
    pub measured_m: f64,
}

/// Depth noise over distance and over angle.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorError {
    /// Noise by distance, facing the plane.
    pub by_distance: Vec<DepthNoise>,
    /// Noise by angle of incidence at 1.2 m.
    pub by_angle: Vec<DepthNoise>,
}

/// Number of placements measured by [`measure`].
pub const N_PLACEMENTS: usize = 31 + 26;

/// Measures the depth noise at all placements; `progress` is called after each.
///
/// # Errors
/// If the renderer rejects its own nominal camera.
pub fn measure(mut progress: impl FnMut()) -> Result<SensorError, Error> {
    let mut noise = |z_m: f64, angle_deg: f64| {
        let angle_rad = angle_deg.to_radians();
        let published = AxialNoise::KINECT_V1.sigma_m(z_m as f32, angle_rad as f32);
        let measured_m = measured_sigma_m(z_m, angle_rad)?;
        progress();
        Ok(DepthNoise {
            z_m,
            angle_deg,
            published_m: published.into(),
            measured_m,
        })
    };
    let by_distance = (0..=30).map(|i| noise(0.5 + 0.1 * f64::from(i), 0.0));
    let by_distance = by_distance.collect::<Result<_, Error>>()?;
    let by_angle = (0..=25).map(|i| noise(TILTED_AT_M, 3.0 * f64::from(i)));
    Ok(SensorError {
        by_distance,
        by_angle: by_angle.collect::<Result<_, Error>>()?,
    })
}

impl SensorError {
    /// Table with a header row, comma-separated (CSV).
    pub fn csv(&self) -> String {
        let mut table = String::from("z_m,angle_deg,published_mm,measured_mm\n");
        for row in self.by_distance.iter().chain(&self.by_angle) {
            let (published_mm, measured_mm) = (row.published_m * 1e3, row.measured_m * 1e3);
            // Writing to a string cannot fail.
            let _ = writeln!(
                table,
                "{:.2},{:.0},{published_mm:.3},{measured_mm:.3}",
                row.z_m, row.angle_deg
            );
        }
        table
    }

    /// Sensor error over distance and angle as SVG.
    ///
    /// # Errors
    /// If the plotting library fails.
    pub fn svg(&self) -> Result<String, DrawingError> {
        side_by_side(&[
            diagram(
                "Spread of depth, facing a plane",
                "distance z (m)",
                &self.by_distance,
                |row| row.z_m,
            ),
            diagram(
                "Spread of depth at 1.2 m",
                "angle of the plane (degrees)",
                &self.by_angle,
                |row| row.angle_deg,
            ),
        ])
    }
}

fn diagram<'a>(
    title: &'a str,
    x_label: &'a str,
    rows: &[DepthNoise],
    x: impl Fn(&DepthNoise) -> f64,
) -> Diagram<'a> {
    let curve = |y: fn(&DepthNoise) -> f64| -> Vec<(f64, f64)> {
        rows.iter().map(|row| (x(row), y(row) * 1e3)).collect()
    };
    let highest_mm = rows
        .iter()
        .map(|row| row.published_m.max(row.measured_m) * 1e3)
        .fold(0.0, f64::max);
    let ends = (rows.first().map_or(0.0, &x), rows.last().map_or(1.0, &x));
    Diagram {
        title,
        x: Axis::linear(x_label, ends.0..ends.1),
        y: Axis::linear("standard deviation (mm)", 0.0..highest_mm * 1.1),
        legend: Legend::UpperLeft,
        curves: vec![
            Curve::line(
                "Nguyen et al. 2012",
                Color::BLUE,
                curve(|row| row.published_m),
            ),
            Curve::marked("simulated Kinect", Color::RED, curve(|row| row.measured_m)),
        ],
    }
}

/// Standard deviation of the depth error in the central block.
fn measured_sigma_m(z_m: f64, angle_rad: f64) -> Result<f64, Error> {
    let mesh = PreparedMesh::new(&plane());
    let mut rasterizer = Rasterizer::new(CAMERA)?;
    let mut camera_from_plane = RigidTransform::translation(0.0, 0.0, z_m);
    // The plane's normal is its z axis, which must point at the camera.
    camera_from_plane.rotation =
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::PI - angle_rad);
    let image = rasterizer.render(&[Instance::new(&mesh, camera_from_plane, 1)]);
    let mut sensor = KinectSensor::new(CAMERA, SensorModel::KINECT_V1)?;
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let mut errors = Vec::new();
    for frame_index in 0..N_FRAMES {
        let shot = FrameSeed {
            seed: 1,
            frame_index,
        };
        sensor.sense(image, shot, &mut points)?;
        errors.extend(block().filter_map(|pixel| {
            let error = f64::from(points[pixel].z) - f64::from(image.depth_m()[pixel]);
            error.is_finite().then_some(error)
        }));
    }
    Ok(standard_deviation(&errors))
}

/// Indices of the central pixels of an image.
fn block() -> impl Iterator<Item = usize> {
    let width = CAMERA.width as usize;
    let (column, row) = (width / 2, CAMERA.height as usize / 2);
    let rows = row - HALF_BLOCK_PX..row + HALF_BLOCK_PX;
    rows.flat_map(move |row| {
        (column - HALF_BLOCK_PX..column + HALF_BLOCK_PX).map(move |column| row * width + column)
    })
}

fn standard_deviation(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    (squares.sum::<f64>() / n).sqrt()
}

/// Large square around the origin with normal z.
fn plane() -> TriangleMesh {
    let corners = [(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)];
    TriangleMesh {
        vertices: corners
            .map(|(x, y)| Vertex {
                position: Point3::new(x, y, 0.0),
                normal: Vector3::z(),
                color: [200; 3],
            })
            .to_vec(),
        triangles: [[0, 1, 2], [0, 2, 3]]
            .map(|vertices| Triangle {
                vertices,
                surface: 0,
            })
            .to_vec(),
        surfaces: vec![Surface::MATTE],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulated_depth_noise_follows_the_published_model() {
        let mut n_calls = 0;
        let figures = measure(|| n_calls += 1).unwrap();
        assert_eq!(n_calls, N_PLACEMENTS);
        for row in figures.by_distance.iter().chain(&figures.by_angle) {
            let ratio = row.measured_m / row.published_m;
            assert!((0.9..1.1).contains(&ratio), "{row:?}");
        }
        assert_eq!(figures.csv().lines().count(), N_PLACEMENTS + 1);
        let svg = figures.svg().unwrap();
        assert!(svg.contains("Nguyen et al. 2012") && svg.contains("simulated Kinect"));
    }
}
