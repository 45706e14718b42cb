//! Directions spread evenly over the sphere: the vertices of an icosphere.

use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Set of directions: the vertices of an icosahedron whose faces are divided into four, once or
/// twice, and pushed out to the unit sphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DirectionSphere {
    /// 42 directions, 32° to 36° from their neighbours.
    Icosphere42,
    /// 162 directions, 16° to 19° from their neighbours.
    Icosphere162,
}

impl DirectionSphere {
    /// Set with a number of directions; `None` if there is none.
    pub fn with_directions(n_directions: usize) -> Option<Self> {
        let all = [Self::Icosphere42, Self::Icosphere162];
        all.into_iter()
            .find(|sphere| sphere.n_directions() == n_directions)
    }

    /// Number of directions.
    pub fn n_directions(self) -> usize {
        match self {
            Self::Icosphere42 => 42,
            Self::Icosphere162 => 162,
        }
    }

    /// Unit vectors of the directions, always in the same order.
    pub fn directions(self) -> Vec<Vector3<f32>> {
        let (mut vertices, mut faces) = icosahedron();
        let n_divisions = match self {
            Self::Icosphere42 => 1,
            Self::Icosphere162 => 2,
        };
        for _ in 0..n_divisions {
            faces = divide(&mut vertices, &faces);
        }
        vertices.iter().map(|vertex| vertex.cast()).collect()
    }
}

/// Vertices and faces of the icosahedron: the corners of three golden rectangles, and the triples
/// of them that are neighbours.
fn icosahedron() -> (Vec<Vector3<f64>>, Vec<[usize; 3]>) {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let corners = signs.map(|(one, other)| (one, other * golden));
    let rectangles = corners.into_iter().flat_map(|(short, long)| {
        [
            Vector3::new(0.0, short, long),
            Vector3::new(short, long, 0.0),
            Vector3::new(long, 0.0, short),
        ]
    });
    let vertices: Vec<_> = rectangles.map(|vertex| vertex.normalize()).collect();
    // Neighbours are 63° apart, the next vertices 117°.
    let are_neighbours = |a: usize, b: usize| vertices[a].dot(&vertices[b]) > 0.0;
    let mut faces = Vec::new();
    for a in 0..vertices.len() {
        for b in a + 1..vertices.len() {
            for c in b + 1..vertices.len() {
                if are_neighbours(a, b) && are_neighbours(b, c) && are_neighbours(a, c) {
                    faces.push([a, b, c]);
                }
            }
        }
    }
    (vertices, faces)
}

/// Divides each face into four at the middles of its edges, which become vertices.
fn divide(vertices: &mut Vec<Vector3<f64>>, faces: &[[usize; 3]]) -> Vec<[usize; 3]> {
    let mut middles = BTreeMap::new();
    let mut middle = |one: usize, other: usize| {
        *middles
            .entry((one.min(other), one.max(other)))
            .or_insert_with(|| {
                vertices.push((vertices[one] + vertices[other]).normalize());
                vertices.len() - 1
            })
    };
    let parts = faces.iter().flat_map(|&[a, b, c]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    });
    parts.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_unit_vectors_spread_evenly() {
        for (sphere, nearest_deg, farthest_deg) in [
            (DirectionSphere::Icosphere42, 31.0, 36.1),
            (DirectionSphere::Icosphere162, 15.0, 19.0),
        ] {
            let directions = sphere.directions();
            assert_eq!(directions.len(), sphere.n_directions());
            assert_eq!(
                DirectionSphere::with_directions(directions.len()),
                Some(sphere)
            );
            for (index, direction) in directions.iter().enumerate() {
                assert!((direction.norm() - 1.0).abs() < 1e-6);
                let others = directions.iter().enumerate().filter(|(i, _)| *i != index);
                let largest = others
                    .map(|(_, other)| direction.dot(other))
                    .fold(-1.0, f32::max);
                let angle_deg = largest.acos().to_degrees();
                assert!(
                    (nearest_deg..farthest_deg).contains(&angle_deg),
                    "{angle_deg}"
                );
            }
            let sum: Vector3<f32> = directions.iter().sum();
            assert!(sum.norm() < 1e-4, "they are balanced: {sum}");
        }
        assert_eq!(DirectionSphere::with_directions(43), None);
    }
}
