//! Ray casting of the synthetic scene.

use super::arrangement::TableObject;
use super::catalogue::{PaintedSurface, ROOM};
use super::paint::Paint;
use super::surface::{Hit, Ray};
use geometry::RigidTransform;
use nalgebra::{Point3, Vector3};

/// Direction to the lamp, world frame, not normalised.
const TO_LAMP: Vector3<f64> = Vector3::new(-0.35, -0.45, 0.9);
/// Ambient brightness of a surface that the lamp does not reach, of 1.
const AMBIENT: f64 = 0.55;

/// First intersection of a ray with the scene.
#[derive(Debug, Clone, Copy)]
pub(super) struct VisibleSurface {
    /// Ray parameter of the intersection.
    pub(super) t: f64,
    /// Unit normal towards the viewer, world frame.
    pub(super) normal: Vector3<f64>,
    /// Colour of the visible surface: red, green, blue.
    pub(super) rgb: [u8; 3],
}

/// Rigid body of painted surfaces.
#[derive(Debug)]
struct SceneBody {
    world_from_local: RigidTransform,
    /// Bounding sphere: centre (world frame) and radius.
    bounds: (Point3<f64>, f64),
    parts: &'static [PaintedSurface],
}

/// Synthetic scene: the room and the objects in it.
#[derive(Debug)]
pub(super) struct SyntheticScene {
    bodies: Vec<SceneBody>,
}

impl SyntheticScene {
    pub(super) fn new(objects: &[TableObject]) -> Self {
        let room = SceneBody {
            world_from_local: RigidTransform::identity(),
            bounds: (Point3::origin(), f64::INFINITY),
            parts: &ROOM,
        };
        let bodies = std::iter::once(room)
            .chain(objects.iter().map(SceneBody::of))
            .collect();
        Self { bodies }
    }

    /// First intersection of a ray (world frame).
    pub(super) fn cast(&self, ray: &Ray) -> Option<VisibleSurface> {
        let nearest = self
            .bodies
            .iter()
            .filter_map(|body| body.hit(ray).map(|(hit, paint)| (hit, paint, body)))
            .min_by(|(a, ..), (b, ..)| a.t.total_cmp(&b.t));
        nearest.map(|(hit, paint, body)| {
            let normal = body.world_from_local.rotation * hit.normal;
            let place = body
                .world_from_local
                .inverse_transform_point(&ray.at(hit.t));
            let light = AMBIENT + (1.0 - AMBIENT) * normal.dot(&TO_LAMP.normalize()).max(0.0);
            let rgb = paint
                .color_at(&place)
                .map(|channel| (channel * light).round() as u8);
            VisibleSurface {
                t: hit.t,
                normal,
                rgb,
            }
        })
    }

    /// True if a surface lies between two points of the world.
    pub(super) fn is_blocked(&self, from: &Point3<f64>, to: &Point3<f64>) -> bool {
        let ray = Ray {
            origin: *from,
            direction: to - from,
        };
        self.bodies
            .iter()
            .any(|body| body.hit(&ray).is_some_and(|(hit, _)| hit.t < 1.0))
    }
}

impl SceneBody {
    fn of(object: &TableObject) -> Self {
        let (centre, radius) = object.kind.bounding_sphere();
        Self {
            world_from_local: object.world_from_object,
            bounds: (object.world_from_object * centre, radius),
            parts: object.kind.parts,
        }
    }

    /// Nearest intersection of a ray (world frame) and its paint; the normal is in the
    /// body frame.
    fn hit(&self, ray: &Ray) -> Option<(Hit, &Paint)> {
        let to_centre = self.bounds.0 - ray.origin;
        if to_centre.cross(&ray.direction).norm() > self.bounds.1 * ray.direction.norm() {
            return None;
        }
        let ray_in_body = Ray {
            origin: self.world_from_local.inverse_transform_point(&ray.origin),
            direction: self
                .world_from_local
                .inverse_transform_vector(&ray.direction),
        };
        self.parts
            .iter()
            .filter_map(|(surface, paint)| surface.hit(&ray_in_body).map(|hit| (hit, paint)))
            .min_by(|(a, _), (b, _)| a.t.total_cmp(&b.t))
    }
}
