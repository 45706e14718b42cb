//! Scores of a pose: contradictions between two views, and the distance of their points.

use crate::near_grid::NearGrid;
use crate::view_surface::ViewSurface;
use nalgebra::{Isometry3, Point3};

/// Tolerance of the seen surface, metres: some standard deviations of the surfels. Chosen.
pub(crate) const TOLERANCE_M: f64 = 0.0025;

/// Weight of a hidden surfel, which neither agrees nor contradicts. Chosen: a pose must not win
/// by hiding everything.
const HIDDEN_WEIGHT: f64 = 0.25;

/// Contradiction of two views in a pose, 0 to 2: of the surfels that the other view should have
/// seen, the mean of 0 for one at its surface and 1 for one that is off by the tolerance. What is
/// hidden from the other view says nothing.
pub(crate) fn contradiction(
    target: &ViewSurface,
    source: &ViewSurface,
    target_from_source: &Isometry3<f64>,
    tolerance_m: f64,
) -> f64 {
    let halves = contradictions(target, source, target_from_source, tolerance_m);
    halves.iter().sum()
}

/// Both halves of the contradiction, 0 to 1 each: of the source's surfels, and of the target's.
pub(crate) fn contradictions(
    target: &ViewSurface,
    source: &ViewSurface,
    target_from_source: &Isometry3<f64>,
    tolerance_m: f64,
) -> [f64; 2] {
    [
        one_way(target, source, target_from_source, tolerance_m),
        one_way(source, target, &target_from_source.inverse(), tolerance_m),
    ]
}

/// Contradiction between the surfels of a surface and the view of another, 0 to 1.
fn one_way(
    seen: &ViewSurface,
    surface: &ViewSurface,
    seen_from_surface: &Isometry3<f64>,
    tolerance_m: f64,
) -> f64 {
    let (mut sum, mut weights) = (0.0, f64::EPSILON);
    for surfel in surface.surfels() {
        let place = seen_from_surface * surfel.place;
        let above = seen.range_image().height_above(&place);
        if above.is_some_and(|above| above > tolerance_m) {
            weights += HIDDEN_WEIGHT;
            continue;
        }
        weights += 1.0;
        let is_at_surface = above.is_some_and(|above| above >= -tolerance_m);
        let nearest = seen.nearest_surfel(&place, tolerance_m);
        sum += match nearest.filter(|_| is_at_surface) {
            Some((other, _)) => {
                let off = (other.place - place).dot(&other.normal) / tolerance_m;
                let turned = (seen_from_surface.rotation * surfel.normal).dot(&other.normal);
                (off * off + 0.5 * (1.0 - turned.abs())).min(1.0)
            }
            None => 1.0,
        };
    }
    sum / weights
}

/// Mean squared distance of points of the source from those of the target that are within the
/// reach of a grid over them, as a share of the squared reach, and the share of points that have
/// one within it.
pub(crate) fn point_distance(
    target: &NearGrid,
    source: &[[f32; 3]],
    target_from_source: &Isometry3<f64>,
) -> (f64, f64) {
    let pose: Isometry3<f32> = target_from_source.cast();
    let (mut sum, mut n_near) = (0.0, 0);
    for point in source {
        let place = pose * Point3::from(*point);
        if let Some(squared) = target.nearest_squared(place.coords.into()) {
            sum += f64::from(squared);
            n_near += 1;
        }
    }
    let squared_reach = f64::from(target.reach_m()).powi(2);
    let share = f64::from(n_near) / source.len().max(1) as f64;
    (sum / squared_reach / f64::from(n_near.max(1)), share)
}
