//! Picture of models: each object beside its models, from one side.

use evaluation::scene_picture::encode;
use geometry::PinholeCamera;
use mesh::TriangleMesh;
use nalgebra::{Isometry3, Point3, Vector3};
use rendering::{Instance, LINEAR_ONE, PreparedMesh, Rasterizer};
use service::Failure;

/// Side of the picture of one model, pixels.
const SIDE_PX: u32 = 200;

/// Distance of the camera in sizes of the object.
const DISTANCE_IN_SIZES: f32 = 2.6;

/// Colour of the background.
const BACKGROUND: [u8; 3] = [245; 3];

/// Draws rows of meshes, those of a row in one frame, from the same place.
pub(super) fn draw(rows: &[Vec<&TriangleMesh>]) -> Result<Vec<u8>, Failure> {
    let n_columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let (width, height) = (SIDE_PX as usize * n_columns, SIDE_PX as usize * rows.len());
    let mut pixels = vec![BACKGROUND; width * height];
    let camera = PinholeCamera {
        fx_px: f64::from(SIDE_PX) * 2.0,
        fy_px: f64::from(SIDE_PX) * 2.0,
        cx_px: f64::from(SIDE_PX) / 2.0 - 0.5,
        cy_px: f64::from(SIDE_PX) / 2.0 - 0.5,
        width: SIDE_PX,
        height: SIDE_PX,
    };
    let mut rasterizer = Rasterizer::new(camera).map_err(Failure::general)?;
    for (row, meshes) in rows.iter().enumerate() {
        let Some(bounds) = meshes.first().and_then(|mesh| mesh.bounds()) else {
            continue;
        };
        let pose = view_pose(&bounds.centre(), bounds.sides().norm());
        for (column, mesh) in meshes.iter().enumerate() {
            let prepared = PreparedMesh::new(mesh);
            let image = rasterizer.render(&[Instance::new(&prepared, pose, 1)]);
            for (index, (color, id)) in image.color().iter().zip(image.instance()).enumerate() {
                let (x, y) = (index % SIDE_PX as usize, index / SIDE_PX as usize);
                if *id == 1 {
                    let at = (row * SIDE_PX as usize + y) * width + column * SIDE_PX as usize + x;
                    pixels[at] = color.map(encoded);
                }
            }
        }
    }
    encode(pixels.as_flattened(), width, height).map_err(Failure::general)
}

/// Pose of the mesh in the frame of a camera that looks at it from the front, above.
fn view_pose(centre: &Point3<f32>, size_m: f32) -> Isometry3<f64> {
    let direction = Vector3::new(0.5, -0.75, 0.5).normalize();
    let camera = centre + direction * DISTANCE_IN_SIZES * size_m;
    let down = Isometry3::look_at_rh(&camera.cast::<f64>(), &centre.cast(), &Vector3::z());
    // Right-handed views look along -z with y up; cameras along z with y down.
    Isometry3::rotation(Vector3::x() * std::f64::consts::PI) * down
}

/// Display value of a linear colour.
fn encoded(value: u16) -> u8 {
    let linear = (f32::from(value) / LINEAR_ONE).clamp(0.0, 1.0);
    (255.0 * linear.powf(1.0 / 2.2)).round() as u8
}
