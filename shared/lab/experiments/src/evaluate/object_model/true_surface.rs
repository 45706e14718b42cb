//! True surface of an object: samples of its mesh, and those of them that an orbit shows.

use dataset::washington::CAMERA;
use geometry::PinholeCamera;
use mesh::TriangleMesh;
use nalgebra::{Isometry3, Point3, Vector3};
use random::Random;
use registration::KdTree;
use rendering::{Instance, PreparedMesh, Rasterizer};
use service::Failure;

/// Number of samples of a surface. Chosen: about 1.5 mm apart on a mug.
const N_SAMPLES: usize = 30_000;

/// Distance behind the rendered surface up to which a sample is visible, metres.
const VISIBLE_M: f64 = 0.002;

/// Cosine of the greatest angle of incidence at which a sample counts as visible, 80°. Chosen: a
/// Kinect measures nothing at more grazing angles.
const INCIDENCE_COSINE_MIN: f64 = 0.17;

/// Distance from the nearest sample, along the surface, within which a distance is taken to the
/// plane of that sample, metres.
const PLANE_REACH_M: f64 = 0.004;

/// Sampled surface of a mesh, in the frame of the mesh.
#[derive(Debug)]
pub(super) struct TrueSurface {
    pub(super) places: Vec<[f32; 3]>,
    normals: Vec<Vector3<f64>>,
    tree: KdTree,
    mesh: PreparedMesh,
}

impl TrueSurface {
    /// Samples a mesh evenly by area.
    pub(super) fn new(mesh: &TriangleMesh, seed: u64) -> Self {
        let mut random = Random::from_seed(seed);
        let corners = |triangle: &mesh::Triangle| {
            let at = |i: u32| {
                mesh.vertices
                    .get(i as usize)
                    .map(|v| v.position.cast::<f64>())
            };
            let [a, b, c] = triangle.vertices;
            Some([at(a)?, at(b)?, at(c)?])
        };
        let triangles: Vec<[Point3<f64>; 3]> = mesh.triangles.iter().filter_map(corners).collect();
        let doubled_area = |[a, b, c]: &[Point3<f64>; 3]| (b - a).cross(&(c - a));
        let total: f64 = triangles.iter().map(|t| doubled_area(t).norm()).sum();
        let (mut places, mut normals) = (Vec::new(), Vec::new());
        let mut owed = 0.0;
        for triangle in &triangles {
            let area = doubled_area(triangle);
            let Some(normal) = area.try_normalize(0.0) else {
                continue;
            };
            owed += area.norm() / total * N_SAMPLES as f64;
            while owed >= 1.0 {
                owed -= 1.0;
                let (root, along) = (random.unit().sqrt(), random.unit());
                let [a, b, c] = triangle;
                let place = a + root * ((1.0 - along) * (b - a) + along * (c - a));
                places.push(place.cast::<f32>().coords.into());
                normals.push(normal);
            }
        }
        Self {
            tree: KdTree::new(&places),
            places,
            normals,
            mesh: PreparedMesh::new(mesh),
        }
    }

    /// Places of the samples.
    pub(super) fn samples(&self) -> impl Iterator<Item = Point3<f64>> {
        self.places.iter().map(|place| Point3::from(*place).cast())
    }

    /// Places of the samples, metres, with their unit normals.
    pub(super) fn oriented_samples(&self) -> impl Iterator<Item = [f32; 6]> {
        self.places
            .iter()
            .zip(&self.normals)
            .map(|(place, normal)| {
                let ([x, y, z], n) = (*place, normal.cast::<f32>());
                [x, y, z, n.x, n.y, n.z]
            })
    }

    /// Distance of a place from the surface, metres.
    pub(super) fn distance_m(&self, place: &Point3<f64>) -> f64 {
        let found = self
            .tree
            .nearest(place.cast::<f32>().coords.into(), f32::INFINITY);
        found.map_or(f64::INFINITY, |(index, squared)| {
            let sample = Point3::from(self.places[index]).cast::<f64>();
            let across = (place - sample).dot(&self.normals[index]).abs();
            let along = (f64::from(squared) - across * across).max(0.0).sqrt();
            if along <= PLANE_REACH_M {
                across
            } else {
                f64::from(squared).sqrt()
            }
        })
    }

    /// Samples that at least one of the cameras sees; poses in the frame of the mesh.
    pub(super) fn visible(
        &self,
        object_from_cameras: &[Isometry3<f64>],
    ) -> Result<Vec<bool>, Failure> {
        let mut rasterizer = Rasterizer::new(CAMERA).map_err(Failure::general)?;
        let mut visible = vec![false; self.places.len()];
        for object_from_camera in object_from_cameras {
            let camera_from_object = object_from_camera.inverse();
            let instance = Instance::new(&self.mesh, camera_from_object, 1);
            let image = rasterizer.render(&[instance]);
            for (index, is_visible) in visible.iter_mut().enumerate() {
                *is_visible |= self.is_seen(index, &camera_from_object, &CAMERA, image.depth_m());
            }
        }
        Ok(visible)
    }

    /// `true` if a sample is at the surface of a depth image, and not at a grazing angle.
    fn is_seen(
        &self,
        index: usize,
        camera_from_object: &Isometry3<f64>,
        camera: &PinholeCamera,
        depths_m: &[f32],
    ) -> bool {
        let place = camera_from_object * Point3::from(self.places[index]).cast::<f64>();
        let normal = camera_from_object * self.normals[index];
        let cosine = -normal.dot(&place.coords) / place.coords.norm();
        let pixel = camera.pixel_of(&place);
        let Some([column, row]) = pixel.filter(|_| cosine >= INCIDENCE_COSINE_MIN) else {
            return false;
        };
        let depth_m = depths_m[row * camera.width as usize + column];
        // The depth changes within a pixel on a slanted surface.
        let slant_m = place.z / camera.fx_px / cosine;
        place.z < f64::from(depth_m) + VISIBLE_M + slant_m
    }
}
