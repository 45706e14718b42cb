//! Hidden places of an object: the space behind what is seen of it that it may fill.

use crate::grasp_scene::GraspScene;
use nalgebra::{Point3, Vector3};

/// Every so many pixels of an object a ray is followed.
const PIXEL_STEP: usize = 3;
/// Depth of an object that is assumed at most, metres.
const DEPTH_MAX_M: f64 = 0.30;

/// Places behind the seen surface of an object, a step apart, metres: an object is taken to be as deep
/// as it is broad, and to stand on the surface below it.
pub(crate) fn hidden_places(
    scene: &GraspScene<'_>,
    object: usize,
    step_m: f64,
) -> impl Iterator<Item = Point3<f64>> {
    let pixels = scene.pixels(object).iter().step_by(PIXEL_STEP);
    let seen: Vec<Point3<f64>> = pixels.filter_map(|p| scene.space.in_plan(*p)).collect();
    let eye = scene.space.eye();
    let extent = SeenExtent::of(&seen, &eye);
    let foot_m = scene.foot_m(&seen);
    seen.into_iter().flat_map(move |place| {
        let ray = (place - eye).normalize() * step_m;
        let steps = 1..=(DEPTH_MAX_M / step_m) as u32;
        let behind = steps.map(move |k| place + ray * f64::from(k));
        behind.take_while(move |p| p.z > foot_m && extent.along_m(p) <= extent.far_m)
    })
}

/// Extent of what is seen of an object along the level direction of sight.
#[derive(Clone, Copy)]
struct SeenExtent {
    sight: Vector3<f64>,
    /// Greatest distance along the direction of sight that the object may have.
    far_m: f64,
}

impl SeenExtent {
    fn of(seen: &[Point3<f64>], eye: &Point3<f64>) -> Self {
        let sum = seen
            .iter()
            .fold(Vector3::zeros(), |sum, place| sum + (place - eye));
        let level = Vector3::new(sum.x, sum.y, 0.0);
        let sight = level.try_normalize(1e-9).unwrap_or_else(Vector3::x);
        let across = Vector3::z().cross(&sight);
        let range = |direction: &Vector3<f64>| {
            let along = seen.iter().map(|place| place.coords.dot(direction));
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                (low.min(at), high.max(at))
            })
        };
        let ((near_m, far_m), (left_m, right_m)) = (range(&sight), range(&across));
        Self {
            sight,
            far_m: far_m.max(near_m + (right_m - left_m)),
        }
    }

    fn along_m(&self, place: &Point3<f64>) -> f64 {
        place.coords.dot(&self.sight)
    }
}
