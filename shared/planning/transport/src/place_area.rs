//! Place: a named area in which objects are set down.

use crate::place_candidates::grid;
use geometry::ConvexPolygon;
use grasping::{GraspScene, PlacedArm};
use nalgebra::{Point2, Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Distance from the given height within which a surface is that of the place, metres.
const SAME_HEIGHT_M: f64 = 0.05;
/// Height over the surface at which the hand must be, metres: the middle of a small object.
const OVER_SURFACE_M: f64 = 0.05;

/// Named area in which objects are set down, frame of planning.
#[derive(Debug, Clone)]
pub struct PlaceArea {
    /// Name of the place.
    pub name: String,
    /// Outline, x and y, metres.
    pub outline: ConvexPolygon,
    /// Height of its surface, metres; `None` for the highest one that is seen there.
    pub height_m: Option<f64>,
}

impl PlaceArea {
    /// Surface in the middle of the place: its index in the scene, and the middle on it. `None` when
    /// none is seen there.
    pub fn surface(&self, scene: &GraspScene<'_>) -> Option<(usize, Point3<f64>)> {
        let corners = self.outline.corners();
        let sum = corners.iter().fold(Vector3::zeros(), |sum, corner| {
            sum + Vector3::new(corner.x, corner.y, 1.0)
        });
        let middle = Point2::from(sum.xy() / sum.z.max(1.0));
        let index = self.surface_at(scene, &middle)?;
        let height_m = scene.surfaces[index].height_at(&middle);
        Some((index, Point3::new(middle.x, middle.y, height_m)))
    }

    /// Index of the surface of the scene on which an object in the middle of a place would stand.
    pub(crate) fn surface_at(&self, scene: &GraspScene<'_>, place: &Point2<f64>) -> Option<usize> {
        let height_at = |index: usize| scene.surfaces[index].height_at(place);
        let is_there = |index: &usize| {
            let is_inside = scene.surfaces[*index].outline.contains(place);
            let is_near = |height_m: f64| (height_at(*index) - height_m).abs() < SAME_HEIGHT_M;
            is_inside && self.height_m.is_none_or(is_near)
        };
        let there = (0..scene.surfaces.len()).filter(is_there);
        there.max_by(|a, b| height_at(*a).total_cmp(&height_at(*b)))
    }
}

/// Share of a place over whose surface the arm reaches with its hand downwards, 0 to 1.
pub fn reached_share(placed: &PlacedArm, area: &PlaceArea, scene: &GraspScene<'_>) -> f64 {
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let is_reached = |place: &Point2<f64>| {
        area.surface_at(scene, place).is_some_and(|index| {
            let height_m = scene.surfaces[index].height_at(place) + OVER_SURFACE_M;
            let pose = Translation3::new(place.x, place.y, height_m) * down;
            placed.arm.can_reach(&placed.plan_from_base.inv_mul(&pose))
        })
    };
    let places = grid(&area.outline);
    let n_reached = places.iter().filter(|place| is_reached(place)).count();
    n_reached as f64 / places.len().max(1) as f64
}
