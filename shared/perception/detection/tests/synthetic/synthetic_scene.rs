//! Synthetic scenes of polygons, boxes, hollow cylinders and balls, rendered by ray casting.
//!
//! World frame: z up, the floor at 0. Every pixel has a ground-truth label.

use geometry::PinholeCamera;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Unit, UnitQuaternion, Vector3};
use point_cloud::{Point, Rgba};

/// Label of a pixel without a surface.
pub(crate) const NOTHING: u16 = 0;
pub(crate) const TABLE: u16 = 1;
pub(crate) const FLOOR: u16 = 2;
pub(crate) const WALL: u16 = 3;
/// Smallest label of an object.
pub(crate) const OBJECT: u16 = 10;

/// Disparity step of a Kinect v1 in inverse depth, 1/metre: 2.85 mm at 1 m.
const INVERSE_DEPTH_STEP: f64 = 0.002_85;

/// Shape in its own frame, standing on z = 0.
#[derive(Debug, Clone)]
pub(crate) enum Shape {
    /// Polygon in z = 0, visible from both sides, possibly concave; corners in metres.
    Polygon(Vec<[f64; 2]>),
    /// Box with full sides, centred over the origin, metres.
    Box([f64; 3]),
    /// Upright cylinder with a bore down to its floor, or through it when the floor is 0;
    /// metres.
    Cylinder {
        radius: f64,
        height: f64,
        bore: f64,
        floor: f64,
    },
    /// Ball of a radius that rests on z = 0, metres.
    Ball(f64),
}

/// Shape placed in the world, with colour and label.
#[derive(Debug, Clone)]
pub(crate) struct PlacedShape {
    shape: Shape,
    world_from_shape: Isometry3<f64>,
    rgb: [u8; 3],
    label: u16,
}

impl PlacedShape {
    pub(crate) fn new(shape: Shape, at: [f64; 3], label: u16) -> Self {
        Self {
            shape,
            world_from_shape: Isometry3::translation(at[0], at[1], at[2]),
            rgb: color_of(label),
            label,
        }
    }

    pub(crate) fn polygon(corners: &[[f64; 2]], z: f64, label: u16) -> Self {
        Self::new(Shape::Polygon(corners.to_vec()), [0.0, 0.0, z], label)
    }

    /// Rectangle centred on the world's z axis.
    pub(crate) fn rectangle(sides: [f64; 2], z: f64, label: u16) -> Self {
        let [x, y] = sides.map(|side| 0.5 * side);
        Self::polygon(&[[-x, -y], [x, -y], [x, y], [-x, y]], z, label)
    }

    pub(crate) fn cuboid(sides: [f64; 3], at: [f64; 3], label: u16) -> Self {
        Self::new(Shape::Box(sides), at, label)
    }

    /// Solid cylinder that stands on the table.
    pub(crate) fn cylinder(radius: f64, height: f64, at: [f64; 3], label: u16) -> Self {
        let (bore, floor) = (0.0, 0.0);
        let shape = Shape::Cylinder {
            radius,
            height,
            bore,
            floor,
        };
        Self::new(shape, at, label)
    }

    /// Wall across the view, behind all objects.
    pub(crate) fn wall(y: f64) -> Self {
        let mut wall = Self::rectangle([8.0, 8.0], 0.0, WALL);
        wall.world_from_shape = Isometry3::new(
            Vector3::new(0.0, y, 0.0),
            Vector3::x() * std::f64::consts::FRAC_PI_2,
        );
        wall
    }

    pub(crate) fn floor() -> Self {
        Self::rectangle([8.0, 8.0], 0.0, FLOOR)
    }

    /// Shape rotated about its own upright axis.
    pub(crate) fn turned(mut self, yaw_deg: f64) -> Self {
        self.world_from_shape.rotation *=
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_deg.to_radians());
        self
    }

    /// Rotated about an axis of the world through its own origin.
    pub(crate) fn tilted(mut self, axis: Unit<Vector3<f64>>, deg: f64) -> Self {
        let turn = UnitQuaternion::from_axis_angle(&axis, deg.to_radians());
        self.world_from_shape.rotation = turn * self.world_from_shape.rotation;
        self
    }

    pub(crate) fn painted(mut self, rgb: [u8; 3]) -> Self {
        self.rgb = rgb;
        self
    }

    /// Depth of the first intersection with a ray.
    fn meet(&self, eye: &Point3<f64>, ray: &Vector3<f64>) -> Option<f64> {
        let eye = self.world_from_shape.inverse_transform_point(eye);
        let ray = self.world_from_shape.inverse_transform_vector(ray);
        match &self.shape {
            Shape::Polygon(corners) => meet_polygon(&eye, &ray, corners),
            Shape::Box(sides) => meet_box(&eye, &ray, sides),
            &Shape::Ball(radius) => meet_ball(&eye, &ray, radius),
            &Shape::Cylinder {
                radius,
                height,
                bore,
                floor,
            } => {
                let meet = meet_cylinder(&eye, &ray, [radius, height, bore, floor]);
                meet.into_iter().flatten().min_by(f64::total_cmp)
            }
        }
    }
}

/// Colour that encodes a label.
fn color_of(label: u16) -> [u8; 3] {
    const COLORS: [[u8; 3]; 10] = [
        [200, 30, 30],
        [30, 160, 40],
        [40, 60, 200],
        [220, 200, 40],
        [160, 40, 170],
        [40, 190, 190],
        [230, 130, 30],
        [90, 60, 40],
        [240, 240, 240],
        [30, 30, 30],
    ];
    match label {
        TABLE => [160, 120, 80],
        FLOOR => [90, 90, 90],
        WALL => [220, 220, 210],
        _ => COLORS[usize::from(label - OBJECT) % COLORS.len()],
    }
}

fn meet_polygon(eye: &Point3<f64>, ray: &Vector3<f64>, corners: &[[f64; 2]]) -> Option<f64> {
    let t = -eye.z / ray.z;
    let at = eye + ray * t;
    let next = corners.iter().cycle().skip(1);
    let crossings = corners.iter().zip(next).filter(|(a, b)| {
        (a[1] > at.y) != (b[1] > at.y)
            && at.x < a[0] + (at.y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    });
    (t > 0.0 && crossings.count() % 2 == 1).then_some(t)
}

/// Intersection of a ray with a box (slab method).
fn meet_box(eye: &Point3<f64>, ray: &Vector3<f64>, sides: &[f64; 3]) -> Option<f64> {
    let (mut near, mut far) = (f64::MIN, f64::MAX);
    for axis in 0..3 {
        let middle = if axis == 2 { 0.5 * sides[2] } else { 0.0 };
        let half = 0.5 * sides[axis];
        let t = [-half, half].map(|side| (middle + side - eye[axis]) / ray[axis]);
        near = near.max(t[0].min(t[1]));
        far = far.min(t[0].max(t[1]));
    }
    (near <= far && near > 0.0).then_some(near)
}

/// First intersection of a ray with a ball that rests on z = 0.
fn meet_ball(eye: &Point3<f64>, ray: &Vector3<f64>, radius: f64) -> Option<f64> {
    let from_centre = eye - Point3::new(0.0, 0.0, radius);
    let (a, b) = (ray.norm_squared(), from_centre.dot(ray));
    let root = b * b - a * (from_centre.norm_squared() - radius * radius);
    let t = (-b - root.max(0.0).sqrt()) / a;
    (root >= 0.0 && t > 0.0).then_some(t)
}

/// All intersections of a ray with a cylinder: side, bore, upper face and floor.
fn meet_cylinder(
    eye: &Point3<f64>,
    ray: &Vector3<f64>,
    [radius, height, bore, floor]: [f64; 4],
) -> [Option<f64>; 6] {
    let (a, b) = (ray.xy().norm_squared(), eye.coords.xy().dot(&ray.xy()));
    let side = |radius: f64, sign: f64, from: f64| {
        let root = b * b - a * (eye.coords.xy().norm_squared() - radius * radius);
        let t = (sign * root.max(0.0).sqrt() - b) / a;
        (root >= 0.0 && t > 0.0 && (from..=height).contains(&(eye.z + t * ray.z))).then_some(t)
    };
    let level = |z: f64, from: f64, to: f64| {
        let t = (z - eye.z) / ray.z;
        let away = (eye.coords.xy() + ray.xy() * t).norm();
        (t > 0.0 && (from..=to).contains(&away)).then_some(t)
    };
    let has_floor = bore > 0.0 && floor > 0.0;
    [
        side(radius, -1.0, 0.0),
        side(radius, 1.0, 0.0).filter(|_| bore > 0.0),
        side(bore, 1.0, floor).filter(|_| bore > 0.0),
        side(bore, -1.0, floor).filter(|_| bore > 0.0),
        level(height, bore, radius),
        level(floor, 0.0, bore).filter(|_| has_floor),
    ]
}

/// Synthetic scene: placed shapes and the camera.
#[derive(Debug, Clone)]
pub(crate) struct SyntheticScene {
    pub(crate) camera: PinholeCamera,
    pub(crate) camera_from_world: Isometry3<f64>,
    pub(crate) solids: Vec<PlacedShape>,
    /// Standard deviation of the depth noise at 1 m, metres; grows with squared depth.
    pub(crate) noise_m: f64,
    /// `true` for depth quantised like that of a Kinect v1.
    pub(crate) is_stepped: bool,
}

impl SyntheticScene {
    /// Empty scene seen from `eye` towards `target`, with horizontal image rows.
    pub(crate) fn seen_from(eye: [f64; 3], target: [f64; 3]) -> Self {
        let (eye, target) = (Point3::from(eye), Point3::from(target));
        let forward = (target - eye).normalize();
        let right = forward.cross(&Vector3::z());
        let right = right.try_normalize(1e-6).unwrap_or_else(Vector3::x);
        let rows = [right, forward.cross(&right), forward].map(|axis| axis.transpose());
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows));
        Self {
            camera: PinholeCamera::KINECT_V1,
            camera_from_world: Isometry3::from_parts(
                (-(rotation * eye.coords)).into(),
                rotation.into(),
            ),
            solids: Vec::new(),
            noise_m: 0.0005,
            is_stepped: false,
        }
    }

    pub(crate) fn with(mut self, solids: impl IntoIterator<Item = PlacedShape>) -> Self {
        self.solids.extend(solids);
        self
    }

    /// The scene in an image scaled by `factor`.
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        let camera = &mut self.camera;
        (camera.fx_px, camera.fy_px) = (factor * camera.fx_px, factor * camera.fy_px);
        camera.cx_px = factor * (camera.cx_px + 0.5) - 0.5;
        camera.cy_px = factor * (camera.cy_px + 0.5) - 0.5;
        camera.width = (factor * f64::from(camera.width)) as u32;
        camera.height = (factor * f64::from(camera.height)) as u32;
        self
    }

    /// Scene without the last columns of the image.
    pub(crate) fn narrowed(mut self, n_columns: u32) -> Self {
        self.camera.width -= n_columns;
        self
    }

    pub(crate) fn up_in_camera(&self) -> Unit<Vector3<f64>> {
        self.camera_from_world.rotation * Vector3::z_axis()
    }

    /// Points and labels of all pixels, by ray casting.
    pub(crate) fn render(&self) -> (Vec<Point>, Vec<u16>) {
        let world_from_camera = self.camera_from_world.inverse();
        let eye = world_from_camera * Point3::origin();
        let width = self.camera.width as usize;
        let pixel = |i: usize| {
            let (column, row) = ((i % width) as f64, (i / width) as f64);
            let ray = world_from_camera.rotation * self.camera.ray(column, row);
            let meets = self.solids.iter().filter_map(|solid| {
                let t = solid.meet(&eye, &ray)?;
                Some((t, solid))
            });
            let Some((z, solid)) = meets.min_by(|a, b| a.0.total_cmp(&b.0)) else {
                return (Point::without_depth(Rgba::default()), NOTHING);
            };
            let p = self.camera.back_project(column, row, self.measured(z, i));
            let [red, green, blue] = solid.rgb;
            let point = Point {
                x: p.x as f32,
                y: p.y as f32,
                z: p.z as f32,
                color: Rgba::opaque(red, green, blue),
            };
            (point, solid.label)
        };
        (0..self.camera.n_pixels()).map(pixel).unzip()
    }

    /// Measured depth of pixel `i` with noise and quantisation.
    fn measured(&self, z: f64, i: usize) -> f64 {
        let draw = |k: usize| random::unit(random::counter_based((4 * i + k) as u64));
        // A sum of four uniform draws is nearly normal; its variance is a third.
        let normal = ((0..4).map(draw).sum::<f64>() - 2.0) * 3_f64.sqrt();
        let noisy = z + self.noise_m * normal * z * z;
        if self.is_stepped {
            1.0 / ((1.0 / noisy / INVERSE_DEPTH_STEP).round() * INVERSE_DEPTH_STEP)
        } else {
            noisy
        }
    }
}
