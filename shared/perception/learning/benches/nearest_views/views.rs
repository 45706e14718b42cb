//! Described views of generated or recorded objects.

use dataset::washington::ObjectDataset;
use description::{AppearanceDescriptor, AppearanceWeights, ObjectPoints};
use household::{categories, generate};
use mesh::TriangleMesh;
use nalgebra::{Point3, UnitVector3, Vector3};
use point_cloud::{Point, Rgba};
use random::Random;
use std::path::Path;

pub(crate) use description::N_AXIS_HYPOTHESES;
pub(crate) const DIMENSION: usize = AppearanceDescriptor::DIMENSION;

/// Number of views of one generated object: turns of 32 at three heights.
const N_VIEWS_OF_OBJECT: usize = 96;

/// Number of points of a generated view.
const N_POINTS: usize = 800;

/// Described view of a benchmark object.
pub(crate) struct View {
    pub(crate) category: String,
    pub(crate) queries: [Vec<f32>; N_AXIS_HYPOTHESES],
}

/// Points of a view and the direction against gravity in their frame.
struct Seen {
    category: String,
    points: Vec<Point>,
    up: UnitVector3<f64>,
}

fn normal_vector(random: &mut Random) -> Vector3<f32> {
    Vector3::new(
        random.normal_f32(),
        random.normal_f32(),
        random.normal_f32(),
    )
}

/// Described views, grouped by object.
pub(crate) fn views(n_views: usize) -> Vec<View> {
    let mut appearance =
        AppearanceDescriptor::new(AppearanceWeights::default()).expect("the weights are valid");
    let mut views = Vec::with_capacity(n_views);
    let mut add = |seen: &Seen| {
        if let Ok(queries) = appearance.describe(ObjectPoints::all(&seen.points), Some(&seen.up)) {
            views.push(View {
                category: seen.category.clone(),
                queries: queries.clone(),
            });
        }
    };
    match std::env::var_os("TABULA_VIEWS") {
        Some(folder) => see_folder(Path::new(&folder), n_views, &mut add),
        None => see_generated(n_views, &mut add),
    }
    views
}

/// Views of a data set, augmented by disturbed copies up to the required number.
fn see_folder(folder: &Path, n_views: usize, add: &mut impl FnMut(&Seen)) {
    let dataset = ObjectDataset::open(folder).expect("TABULA_VIEWS names a folder of views");
    let mut random = Random::from_seed(7);
    let n_copies = n_views.div_ceil(dataset.n_views());
    for (i, name) in dataset.names().enumerate() {
        let elevation_deg = match name.sequence() {
            1 => 30.0_f64,
            2 => 45.0,
            _ => 60.0,
        };
        let (sin, cos) = elevation_deg.to_radians().sin_cos();
        let points = dataset.load_cloud(i).expect("a view has points");
        let mut seen = Seen {
            category: name.category().to_owned(),
            points: points.clone(),
            up: UnitVector3::new_normalize(Vector3::new(0.0, -sin, -cos)),
        };
        add(&seen);
        for _ in 1..n_copies {
            seen.points = disturbed(&points, &mut random);
            add(&seen);
        }
    }
}

/// Augmented copy: scaled by at most 6 %, noise of at most 2 mm, and up to a quarter of
/// the points removed on one side.
fn disturbed(points: &[Point], random: &mut Random) -> Vec<Point> {
    let centre = points
        .iter()
        .fold(Vector3::zeros(), |sum, p| sum + position(p))
        / points.len().max(1) as f32;
    let scale = 0.94 + 0.12 * random.unit_f32();
    let deviation_m = 0.002 * random.unit_f32();
    let direction = normal_vector(random);
    let along = |p: &Point| (position(p) - centre).dot(&direction);
    let mut sorted: Vec<f32> = points.iter().map(along).collect();
    sorted.sort_by(f32::total_cmp);
    let kept = 1.0 - 0.25 * random.unit_f32();
    let limit = sorted.get((kept * sorted.len() as f32) as usize);
    let limit = limit.copied().unwrap_or(f32::INFINITY);
    let remaining = points.iter().filter(|p| along(p) <= limit);
    remaining
        .map(|p| {
            let place =
                centre + scale * (position(p) - centre) + deviation_m * normal_vector(random);
            Point {
                x: place.x,
                y: place.y,
                z: place.z,
                ..*p
            }
        })
        .collect()
}

fn position(point: &Point) -> Vector3<f32> {
    Vector3::new(point.x, point.y, point.z)
}

/// Views of generated objects of all categories: points on front faces, without
/// occlusion.
fn see_generated(n_views: usize, add: &mut impl FnMut(&Seen)) {
    let mut random = Random::from_seed(7);
    let n_instances = n_views.div_ceil(N_VIEWS_OF_OBJECT * categories().len()) as u64;
    for category in categories() {
        for instance in 0..n_instances {
            let object = generate(category, instance);
            for view in 0..N_VIEWS_OF_OBJECT {
                let yaw_rad = view as f32 * std::f32::consts::TAU / 32.0;
                let pitch_rad = [0.5_f32, 0.8, 1.05][view / 32 % 3];
                let (sin, cos) = pitch_rad.sin_cos();
                let viewer = Vector3::new(cos * yaw_rad.cos(), cos * yaw_rad.sin(), sin);
                add(&Seen {
                    category: category.name.to_owned(),
                    points: sampled(&object.mesh, &viewer, &mut random),
                    up: Vector3::z_axis(),
                });
            }
        }
    }
}

/// Sample of the front faces, as dense as the viewer sees them, with noise of a
/// millimetre.
fn sampled(mesh: &TriangleMesh, viewer: &Vector3<f32>, random: &mut Random) -> Vec<Point> {
    let mut seen_area = 0.0;
    let mut faces = Vec::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.vertices.map(|i| mesh.vertices[i as usize]);
        let (ab, ac) = (b.position - a.position, c.position - a.position);
        let area = 0.5 * ab.cross(&ac).dot(viewer);
        if area > 0.0 {
            seen_area += area;
            faces.push((seen_area, a, ab, ac));
        }
    }
    (0..N_POINTS)
        .filter_map(|_| {
            let wanted = random.unit_f32() * seen_area;
            let face = faces.partition_point(|face| face.0 < wanted);
            let (_, corner, ab, ac) = faces.get(face)?;
            let (u, v) = (random.unit_f32(), random.unit_f32());
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            let place: Point3<f32> =
                corner.position + ab * u + ac * v + 0.001 * normal_vector(random);
            let [red, green, blue] = corner.color;
            Some(Point {
                x: place.x,
                y: place.y,
                z: place.z,
                color: Rgba::opaque(red, green, blue),
            })
        })
        .collect()
}
