//! Simplified contact faces for resting contacts in a physics engine.

use crate::{Bounds, ConvexPart};
use nalgebra::{Point3, Vector3};

/// Tolerance of coplanar points of a face, metres. Chosen.
const COPLANAR_M: f32 = 0.0002;
/// Retraction of a point from its face, metres. Chosen.
const RETRACTION_M: f32 = 0.0012;

/// Reduces every axis-aligned face of a part to at most four corners: four far apart are kept,
/// the others are retracted. If one part has a broad base, the bases of the other parts are
/// retracted.
///
/// Physics engines compute the contact of two faces from few of their corners; when
/// these are neighbours, a body that stands on a polygon sinks in next to them. Parts
/// that share the weight of a body cause jitter.
pub fn simplify_contact_faces(mut parts: Vec<ConvexPart>) -> Vec<ConvexPart> {
    for part in &mut parts {
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let mut outward = Vector3::zeros();
                outward[axis] = sign;
                retract_extra_corners(part.points.iter_mut().collect(), axis, outward);
            }
        }
    }
    keep_broadest_base(&mut parts);
    parts
}

/// Retracts the lowest points of all parts but the broadest one, if that one is broad.
fn keep_broadest_base(parts: &mut [ConvexPart]) {
    let points = parts.iter().flat_map(|part| &part.points);
    let bottom = points.map(|p| p.z).fold(f32::MAX, f32::min);
    let is_foot = |p: &&Point3<f32>| p.z - bottom < COPLANAR_M;
    let breadth = |points: &mut dyn Iterator<Item = &Point3<f32>>| {
        let bounds = Bounds::of(points.filter(is_foot).copied());
        bounds.map_or(0.0, |bounds| bounds.sides().x.min(bounds.sides().y))
    };
    let whole = breadth(&mut parts.iter().flat_map(|part| &part.points));
    let breadths: Vec<f32> = parts
        .iter()
        .map(|part| breadth(&mut part.points.iter()))
        .collect();
    let broadest = (0..parts.len()).max_by(|&i, &k| breadths[i].total_cmp(&breadths[k]));
    let Some(kept) = broadest.filter(|&i| breadths[i] > 0.5 * whole) else {
        return;
    };
    for (_, part) in parts.iter_mut().enumerate().filter(|(i, _)| *i != kept) {
        let feet = part.points.iter_mut();
        for point in feet.filter(|p| p.z - bottom < COPLANAR_M) {
            point.z += RETRACTION_M;
        }
    }
}

fn retract_extra_corners(points: Vec<&mut Point3<f32>>, axis: usize, outward: Vector3<f32>) {
    let height = |p: &Point3<f32>| p.coords.dot(&outward);
    let top = points.iter().map(|p| height(p)).fold(f32::MIN, f32::max);
    let in_face = |p: &&mut Point3<f32>| top - height(p) < COPLANAR_M;
    let mut face: Vec<&mut Point3<f32>> = points.into_iter().filter(in_face).collect();
    if face.len() <= 4 {
        return;
    }
    let kept = diagonal_extremes(&face, (axis + 1) % 3, (axis + 2) % 3);
    for (i, point) in face.iter_mut().enumerate() {
        if !kept.contains(&i) {
            **point -= outward * RETRACTION_M;
        }
    }
}

/// Indices of the outermost points along the diagonals of a plane.
fn diagonal_extremes(face: &[&mut Point3<f32>], u: usize, v: usize) -> Vec<usize> {
    let diagonals = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let outermost = |(a, b): (f32, f32)| {
        let along = |i: &usize| a * face[*i][u] + b * face[*i][v];
        (0..face.len()).max_by(|i, k| along(i).total_cmp(&along(k)))
    };
    diagonals.into_iter().filter_map(outermost).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drum_stands_on_four_corners_that_surround_its_middle() {
        let ring = |z: f32| {
            (0..12)
                .map(|k| (k as f32 * std::f32::consts::FRAC_PI_6).sin_cos())
                .map(move |(sin, cos)| Point3::new(0.05 * cos, 0.05 * sin, z))
        };
        let drum = ConvexPart {
            points: ring(0.0).chain(ring(0.1)).collect(),
        };
        let standing = simplify_contact_faces(vec![drum.clone()]).remove(0);
        let feet: Vec<_> = standing.points.iter().filter(|p| p.z < 1e-5).collect();
        assert_eq!(feet.len(), 4);
        for (a, b) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
            assert!(feet.iter().any(|p| a * p.x > 0.02 && b * p.y > 0.02));
        }
        for (before, after) in drum.points.iter().zip(&standing.points) {
            assert!((before - after).norm() < 2.0 * RETRACTION_M);
        }
    }

    #[test]
    fn a_box_stays_as_it_is() {
        let parts = crate::rounded_box([0.1, 0.2, 0.3], 0.0, 0.1).convex_parts;
        assert_eq!(simplify_contact_faces(parts.clone()), parts);
    }
}
