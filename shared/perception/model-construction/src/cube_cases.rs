//! Cases of marching cubes: the polygons that separate the inner from the outer corners of a cube.

use std::sync::OnceLock;

/// Number of edges of a cube.
const N_EDGES: usize = 12;

/// Edge of a cube: its lower corner and its axis. Bit `axis` of a corner is its coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct CubeEdge {
    pub(crate) corner: usize,
    pub(crate) axis: usize,
}

/// Triangles of a case, by the numbers of their edges.
pub(crate) type CaseTriangles = Vec<[usize; 3]>;

/// Edges of a cube in the order of their numbers: four along x, then y, then z.
pub(crate) const EDGES: [CubeEdge; N_EDGES] = edges();

const fn edges() -> [CubeEdge; N_EDGES] {
    let mut edges = [CubeEdge { corner: 0, axis: 0 }; N_EDGES];
    let mut n = 0;
    let mut axis = 0;
    while axis < 3 {
        let mut corner = 0;
        while corner < 8 {
            if corner >> axis & 1 == 0 {
                edges[n] = CubeEdge { corner, axis };
                n += 1;
            }
            corner += 1;
        }
        axis += 1;
    }
    edges
}

/// Triangles of all cases (Lorensen and Cline 1987); bit `c` of a case says that corner `c` is
/// inside. Where two inner corners of a face are diagonal to each other they are kept apart,
/// which neighbouring cubes do alike: the surface has no holes.
pub(crate) fn cases() -> &'static [CaseTriangles] {
    static CASES: OnceLock<Vec<CaseTriangles>> = OnceLock::new();
    CASES.get_or_init(|| (0..256).map(triangles).collect())
}

/// Number of the edge between two neighbouring corners.
fn edge_between(a: usize, b: usize) -> usize {
    let edge = CubeEdge {
        corner: a & b,
        axis: (a ^ b).trailing_zeros() as usize,
    };
    let is_it = |other: &CubeEdge| *other == edge;
    EDGES.iter().position(is_it).unwrap_or_default()
}

/// Corners of a face, counter-clockwise seen from outside.
fn face_corners(axis: usize, side: usize) -> [usize; 4] {
    let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    let base = side << axis;
    if side == 1 {
        [base, base | u, base | u | v, base | v]
    } else {
        [base, base | v, base | u | v, base | u]
    }
}

/// Triangles of a case: on each face a line leads from the edge where its inner corners begin to
/// the one where they end; the lines of the six faces close to polygons.
fn triangles(case: usize) -> CaseTriangles {
    let is_inside = |corner: usize| case >> corner & 1 == 1;
    let mut next = [None; N_EDGES];
    for face in 0..6 {
        let corners = face_corners(face / 2, face % 2);
        for i in 0..4 {
            let (before, first) = (corners[(i + 3) % 4], corners[i]);
            if is_inside(before) || !is_inside(first) {
                continue;
            }
            let mut last = i;
            while is_inside(corners[(last + 1) % 4]) {
                last += 1;
            }
            let end = edge_between(corners[last % 4], corners[(last + 1) % 4]);
            next[edge_between(before, first)] = Some(end);
        }
    }
    let mut found = Vec::new();
    for start in 0..N_EDGES {
        let mut polygon = Vec::new();
        let mut at = start;
        while let Some(following) = next[at].take() {
            polygon.push(at);
            at = following;
        }
        for i in 2..polygon.len() {
            found.push([polygon[0], polygon[i - 1], polygon[i]]);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_corner_gives_one_triangle_and_four_of_a_side_a_square() {
        assert_eq!(cases()[1].len(), 1);
        assert_eq!(cases()[0b1111].len(), 2);
        assert!(cases()[0].is_empty() && cases()[255].is_empty());
    }

    #[test]
    fn each_case_uses_exactly_the_edges_between_inside_and_outside() {
        for (case, triangles) in cases().iter().enumerate() {
            let mut used: Vec<usize> = triangles.iter().flatten().copied().collect();
            used.sort_unstable();
            used.dedup();
            let is_inside = |corner: usize| case >> corner & 1 == 1;
            let crossed: Vec<usize> = (0..N_EDGES)
                .filter(|&n| {
                    let CubeEdge { corner, axis } = EDGES[n];
                    is_inside(corner) != is_inside(corner | 1 << axis)
                })
                .collect();
            assert_eq!(used, crossed, "case {case}");
        }
    }
}
