//! Candidate poses in an area, those that leave most room for later objects first.

use geometry::{ConvexPolygon, RigidTransform};
use nalgebra::{Point2, Point3, Translation3, UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_4, PI};

/// Distance between the candidates, metres.
const STEP_M: f64 = 0.02;
/// Number of turns about the vertical.
const N_TURNS: i32 = 8;
/// Distance for which an eighth of a turn counts, metres: an object rather stands as it stood.
const TURN_COST_M: f64 = 0.015;
/// Greatest number of places along a side of an area.
const N_STEPS_MAX: f64 = 60.0;

/// Pose of an object in an area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlaceCandidate {
    /// Middle of the object.
    pub(crate) place: Point2<f64>,
    /// Turn about the vertical, radians.
    pub(crate) turn_rad: f64,
}

impl PlaceCandidate {
    /// Motion of an object with its middle at a place: to the candidate, turned, and up.
    pub(crate) fn motion(&self, middle: &Point3<f64>, up_m: f64) -> RigidTransform {
        let to = Vector3::new(self.place.x, self.place.y, middle.z + up_m);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.turn_rad);
        Translation3::from(to) * turn * Translation3::from(-middle.coords)
    }
}

/// Candidates on a grid. The corner that is farthest from the arm's base is filled first: nearer
/// objects would stand in the way to it.
pub(crate) fn place_candidates(outline: &ConvexPolygon, base: &Point2<f64>) -> Vec<PlaceCandidate> {
    let corners = outline.corners();
    let far = corners
        .iter()
        .max_by(|a, b| (*a - base).norm().total_cmp(&(*b - base).norm()));
    let Some(far) = far else {
        return Vec::new();
    };
    let turns = (0..N_TURNS).map(|turn| {
        let turn_rad = f64::from(turn) * FRAC_PI_4;
        if turn_rad > PI {
            turn_rad - 2.0 * PI
        } else {
            turn_rad
        }
    });
    let turns: Vec<f64> = turns.collect();
    let places = grid(outline).into_iter();
    let mut candidates: Vec<PlaceCandidate> = places
        .flat_map(|place| turns.iter().map(move |turn_rad| (place, *turn_rad)))
        .map(|(place, turn_rad)| PlaceCandidate { place, turn_rad })
        .collect();
    let cost_m = |candidate: &PlaceCandidate| {
        (candidate.place - far).norm() + TURN_COST_M * candidate.turn_rad.abs() / FRAC_PI_4
    };
    candidates.sort_by(|a, b| cost_m(a).total_cmp(&cost_m(b)));
    candidates
}

/// Places on a grid over an outline, its edges included.
pub(crate) fn grid(outline: &ConvexPolygon) -> Vec<Point2<f64>> {
    let mut corners = outline.corners().iter();
    let Some(first) = corners.next() else {
        return Vec::new();
    };
    let (low, high) = corners.fold((*first, *first), |(low, high), corner| {
        (low.inf(corner), high.sup(corner))
    });
    let n = (high - low).map(|side| (side / STEP_M).ceil().min(N_STEPS_MAX) as i32);
    let share = |k: i32, n: i32| f64::from(k) / f64::from(n.max(1));
    let rows = (0..=n.x).flat_map(|i| (0..=n.y).map(move |j| (i, j)));
    let places = rows.map(|(i, j)| {
        Point2::new(
            low.x + (high.x - low.x) * share(i, n.x),
            low.y + (high.y - low.y) * share(j, n.y),
        )
    });
    places.filter(|place| outline.contains(place)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_fill_the_far_corner_first_and_stay_inside() {
        let mut corners = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.2], [0.0, 0.2]].map(Point2::from);
        let outline = ConvexPolygon::convex_hull_of(&mut corners);
        let candidates = place_candidates(&outline, &Point2::new(-1.0, -1.0));
        assert!(candidates.len() > 16 * 11 * 7, "{}", candidates.len());
        assert!((candidates[0].place - Point2::new(0.3, 0.2)).norm() < 1e-9);
        assert!(candidates[0].turn_rad.abs() < 1e-12);
        assert!(candidates.iter().all(|c| c.turn_rad.abs() <= PI + 1e-9));
        let inside = |c: &PlaceCandidate| outline.signed_distance_m(&c.place) > -1e-9;
        assert!(candidates.iter().all(inside));
        let empty = ConvexPolygon::convex_hull_of(&mut []);
        assert!(place_candidates(&empty, &Point2::origin()).is_empty());
    }

    #[test]
    fn motion_turns_an_object_about_its_middle() {
        let candidate = PlaceCandidate {
            place: Point2::new(0.4, 0.1),
            turn_rad: PI / 2.0,
        };
        let middle = Point3::new(0.1, 0.2, 0.05);
        let motion = candidate.motion(&middle, 0.004);
        assert!((motion * middle - Point3::new(0.4, 0.1, 0.054)).norm() < 1e-12);
        let side = motion * (middle + Vector3::x() * 0.03);
        assert!((side - Point3::new(0.4, 0.13, 0.054)).norm() < 1e-12);
    }
}
