//! Rendered table with boxes, by ray casting.

use geometry::PinholeCamera;
use nalgebra::{Isometry3, Point3, Rotation3, Vector3};
use point_cloud::{Point, Rgba};

/// Box on the table: centre of its footprint and full sides, table frame, metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoxOnTable {
    pub(crate) centre: [f64; 2],
    /// Height of the bottom over the table, metres.
    pub(crate) bottom: f64,
    pub(crate) sides: [f64; 3],
    pub(crate) rgb: [u8; 3],
}

/// Stack of a small blue box on a wide red one, in this order: the lower, the upper.
#[allow(dead_code, reason = "not every test has a stack")]
pub(crate) fn stack() -> [BoxOnTable; 2] {
    [
        BoxOnTable {
            centre: [0.0, 0.0],
            bottom: 0.0,
            sides: [0.24, 0.16, 0.06],
            rgb: [200, 30, 30],
        },
        BoxOnTable {
            centre: [0.0, 0.02],
            bottom: 0.06,
            sides: [0.08, 0.06, 0.14],
            rgb: [30, 30, 200],
        },
    ]
}

/// Camera pose: it looks at the table's origin from 1 m away, 35 degrees downwards. The
/// table is 1.2 m by 0.8 m, with a wall behind it and the floor 0.7 m below.
pub(crate) fn camera_from_table() -> Isometry3<f64> {
    let pitch = 35_f64.to_radians();
    let (sin, cos) = pitch.sin_cos();
    // Table: x right, y away from the camera, z up. Camera: x right, y down, z forward.
    let rows = nalgebra::Matrix3::new(1.0, 0.0, 0.0, 0.0, -sin, -cos, 0.0, cos, -sin);
    let rotation = Rotation3::from_matrix_unchecked(rows);
    Isometry3::from_parts(Vector3::new(0.0, 0.0, 1.0).into(), rotation.into())
}

/// Render the scene by casting a ray through every pixel. `noise` scales the uniform depth
/// jitter, 2 mm wide at 1 m and growing with squared depth.
pub(crate) fn render(boxes: &[BoxOnTable], noise: f64) -> Vec<Point> {
    let camera = PinholeCamera::KINECT_V1;
    let table_from_camera = camera_from_table().inverse();
    let eye = table_from_camera * Point3::origin();
    let pixels =
        (0..camera.height).flat_map(|row| (0..camera.width).map(move |column| (column, row)));
    let point_of = |(i, (column, row)): (usize, (u32, u32))| {
        let ray = camera.ray(f64::from(column), f64::from(row));
        let direction = table_from_camera.rotation * ray;
        let Some((z, rgb)) = nearest(&eye, &direction, boxes) else {
            return Point::without_depth(Rgba::default());
        };
        let jitter = (i as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let p = camera.back_project(
            f64::from(column),
            f64::from(row),
            z + 0.002 * noise * jitter * z * z,
        );
        let [red, green, blue] = rgb;
        Point {
            x: p.x as f32,
            y: p.y as f32,
            z: p.z as f32,
            color: Rgba::opaque(red, green, blue),
        }
    };
    pixels.enumerate().map(point_of).collect()
}

/// Depth along the ray and colour of the nearest surface.
fn nearest(
    eye: &Point3<f64>,
    direction: &Vector3<f64>,
    boxes: &[BoxOnTable],
) -> Option<(f64, [u8; 3])> {
    let at = |t: f64| eye + direction * t;
    let mut best: Option<(f64, [u8; 3])> = None;
    let mut meet = |t: f64, rgb: [u8; 3]| {
        if t > 0.0 && best.is_none_or(|(nearest, _)| t < nearest) {
            best = Some((t, rgb));
        }
    };
    let table = -eye.z / direction.z;
    if at(table).x.abs() <= 0.6 && at(table).y.abs() <= 0.4 {
        meet(table, [160, 120, 80]);
    }
    meet((-0.7 - eye.z) / direction.z, [90, 90, 90]);
    meet((0.9 - eye.y) / direction.y, [220, 220, 220]);
    for solid in boxes {
        if let Some(t) = enter(eye, direction, solid) {
            meet(t, solid.rgb);
        }
    }
    best
}

/// Depth at which a ray enters a box (slab method).
fn enter(eye: &Point3<f64>, direction: &Vector3<f64>, solid: &BoxOnTable) -> Option<f64> {
    let centre = [
        solid.centre[0],
        solid.centre[1],
        solid.bottom + 0.5 * solid.sides[2],
    ];
    let (mut near, mut far) = (f64::MIN, f64::MAX);
    for axis in 0..3 {
        let half = 0.5 * solid.sides[axis];
        let t = [-half, half].map(|side| (centre[axis] + side - eye[axis]) / direction[axis]);
        near = near.max(t[0].min(t[1]));
        far = far.min(t[0].max(t[1]));
    }
    (near <= far && near > 0.0).then_some(near)
}
