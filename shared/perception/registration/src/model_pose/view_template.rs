//! View templates: the parts of a model that are seen from directions all around it.

use crate::range_image::vector_across;
use nalgebra::{Isometry3, Point3, UnitQuaternion, UnitVector3, Vector3};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// Number of directions. Chosen: 20° between neighbours, which is within reach of the alignment.
const N_DIRECTIONS: usize = 100;

/// Number of turns about each direction, 15° apart. Chosen likewise.
const N_TURNS: usize = 24;

/// Side of the cells of the depth buffer as a multiple of the spacing of the points. Chosen: no
/// cell of a closed surface is empty.
const CELL_IN_SPACINGS: f64 = 2.0;

/// Depth behind the nearest point of a cell up to which a point is seen, in cells. Chosen: a
/// surface may be slanted by 45°.
const SEEN_DEPTH_CELLS: f64 = 1.0;

/// Number of places of a template at which a segment may lie. Chosen.
const N_ANCHORS: usize = 7;

/// Spread of a segment as a share of that of a template below which it may be a part of it. Chosen.
const PART_SPREAD: f64 = 0.85;

/// Greatest number of points of a template. Chosen.
const N_POINTS_MAX: usize = 240;

/// Part of a model that is seen from a direction, frame of the model.
#[derive(Debug, Clone)]
pub(super) struct ViewTemplate {
    /// Direction towards the viewer.
    towards: UnitVector3<f64>,
    /// Evenly strided points that are seen.
    pub(super) points: Vec<Point3<f64>>,
    /// Places of the template that a segment's centroid may have: its own centroid, and points
    /// spread over it, for a segment that is a part of it.
    anchors: Vec<Point3<f64>>,
    /// Root mean square distance of the points from their centroid, metres.
    spread_m: f64,
}

impl ViewTemplate {
    /// Templates of the points of a closed surface with a spacing, metres, from all directions.
    pub(super) fn all_around(points: &[Point3<f64>], spacing_m: f64) -> Vec<Self> {
        let template = |towards| Self::new(points, towards, CELL_IN_SPACINGS * spacing_m);
        directions().map(template).collect()
    }

    fn new(points: &[Point3<f64>], towards: UnitVector3<f64>, cell_m: f64) -> Self {
        let across = vector_across(&towards);
        let axes = [across, towards.cross(&across)];
        let cell = |point: &Point3<f64>| {
            axes.map(|axis| (axis.dot(&point.coords) / cell_m).floor() as i32)
        };
        let height = |point: &Point3<f64>| towards.dot(&point.coords);
        let mut highest_of_cell = HashMap::new();
        for point in points {
            let highest = highest_of_cell
                .entry(cell(point))
                .or_insert(f64::NEG_INFINITY);
            *highest = height(point).max(*highest);
        }
        let is_seen = |point: &&Point3<f64>| {
            let highest = highest_of_cell.get(&cell(point));
            highest.is_some_and(|highest| height(point) > highest - SEEN_DEPTH_CELLS * cell_m)
        };
        let seen: Vec<Point3<f64>> = points.iter().filter(is_seen).copied().collect();
        let step = seen.len().div_ceil(N_POINTS_MAX).max(1);
        let points: Vec<Point3<f64>> = seen.into_iter().step_by(step).collect();
        let (centroid, spread_m) = centroid_and_spread(points.iter());
        Self {
            towards,
            anchors: anchors(&points, centroid),
            points,
            spread_m,
        }
    }

    /// Poses `camera_from_model` in which the camera sees the template around a segment, with its
    /// centroid and spread, in all turns about the line of sight: the centroid of the template at
    /// that of the segment, and for a small segment other parts of the template as well.
    pub(super) fn poses_at(
        &self,
        place: Point3<f64>,
        spread_m: f64,
    ) -> impl Iterator<Item = Isometry3<f64>> {
        let is_part = spread_m < PART_SPREAD * self.spread_m;
        let n_anchors = if is_part { self.anchors.len() } else { 1 };
        let to_camera = UnitVector3::new_normalize(-place.coords);
        let facing = UnitQuaternion::rotation_between(&self.towards, &to_camera);
        // Between opposite directions any half turn does.
        let half_turn = || {
            let across = UnitVector3::new_normalize(vector_across(&self.towards));
            UnitQuaternion::from_axis_angle(&across, PI)
        };
        let facing = facing.unwrap_or_else(half_turn);
        (0..N_TURNS).flat_map(move |turn| {
            let angle_rad = TAU * turn as f64 / N_TURNS as f64;
            let rotation = UnitQuaternion::from_axis_angle(&to_camera, angle_rad) * facing;
            self.anchors[..n_anchors].iter().map(move |anchor| {
                let shift = place - rotation * anchor;
                Isometry3::from_parts(shift.into(), rotation)
            })
        })
    }

    /// Template whose direction is nearest to that towards the camera in a pose.
    pub(super) fn seen_at<'a>(
        templates: &'a [Self],
        camera_from_model: &Isometry3<f64>,
        place: &Point3<f64>,
    ) -> Option<&'a Self> {
        let to_camera = camera_from_model.rotation.inverse() * -place.coords;
        let cosine = |template: &Self| template.towards.dot(&to_camera);
        let by_cosine = |a: &&Self, b: &&Self| cosine(a).total_cmp(&cosine(b));
        templates.iter().max_by(by_cosine)
    }
}

/// Centroid of points and their root mean square distance from it, metres.
pub(super) fn centroid_and_spread<'a>(
    points: impl Iterator<Item = &'a Point3<f64>> + Clone,
) -> (Point3<f64>, f64) {
    let n = points.clone().count().max(1) as f64;
    let sum: Vector3<f64> = points.clone().map(|point| point.coords).sum();
    let centroid = Point3::from(sum / n);
    let squared: f64 = points.map(|point| (point - centroid).norm_squared()).sum();
    (centroid, (squared / n).sqrt())
}

/// A first place, and points that are each as far as possible from all before (farthest point
/// sampling).
fn anchors(points: &[Point3<f64>], first: Point3<f64>) -> Vec<Point3<f64>> {
    let mut anchors = vec![first];
    for _ in 1..N_ANCHORS {
        let clearance = |point: &Point3<f64>| {
            let distances = anchors.iter().map(|anchor| (point - anchor).norm());
            distances.fold(f64::INFINITY, f64::min)
        };
        let farther = |a: &&Point3<f64>, b: &&Point3<f64>| clearance(a).total_cmp(&clearance(b));
        let farthest = points.iter().max_by(farther).copied();
        anchors.extend(farthest);
    }
    anchors
}

/// Directions all around: a Fibonacci lattice on the sphere.
pub(super) fn directions() -> impl Iterator<Item = UnitVector3<f64>> {
    let golden_angle_rad = PI * (3.0 - 5.0_f64.sqrt());
    (0..N_DIRECTIONS).map(move |index| {
        let z = 1.0 - (2.0 * index as f64 + 1.0) / N_DIRECTIONS as f64;
        let (sin, cos) = (golden_angle_rad * index as f64).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        UnitVector3::new_normalize(Vector3::new(radius * cos, radius * sin, z))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points 3 mm apart on the six faces of a cube with sides of 6 cm.
    fn cube() -> Vec<Point3<f64>> {
        let step = |i: i32| 0.003 * f64::from(i - 10);
        let mut points = Vec::new();
        for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (i, j))) {
            for side in [-0.03, 0.03] {
                points.push(Point3::new(step(i), step(j), side));
                points.push(Point3::new(step(i), side, step(j)));
                points.push(Point3::new(side, step(i), step(j)));
            }
        }
        points
    }

    #[test]
    fn only_the_near_sides_of_a_cube_are_seen() {
        for template in ViewTemplate::all_around(&cube(), 0.003) {
            let towards = template.towards;
            let is_near = |point: &&Point3<f64>| {
                (0..3).any(|axis| point[axis].abs() > 0.0299 && point[axis] * towards[axis] > 0.0)
            };
            let n_near = template.points.iter().filter(is_near).count();
            assert!(n_near > 100 && 10 * n_near > 6 * template.points.len());
            // Of the far sides no more is seen than what is near an edge.
            let is_low = |point: &&Point3<f64>| towards.dot(&point.coords) < 0.0;
            let far = template.points.iter().filter(|point| !is_near(point));
            assert!(20 * far.filter(is_low).count() < template.points.len());
        }
    }

    #[test]
    fn poses_show_the_template_to_the_camera() {
        let place = Point3::new(0.1, -0.2, 0.9);
        let templates = ViewTemplate::all_around(&cube(), 0.003);
        for template in &templates {
            for pose in template.poses_at(place, template.spread_m) {
                assert!((pose * template.anchors[0] - place).norm() < 1e-9);
                let towards = pose.rotation * template.towards.into_inner();
                assert!((towards + place.coords.normalize()).norm() < 1e-6);
                let seen = ViewTemplate::seen_at(&templates, &pose, &place).unwrap();
                assert_eq!(seen.towards, template.towards);
            }
        }
    }
}
