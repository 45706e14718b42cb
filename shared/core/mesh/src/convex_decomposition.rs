//! Approximate convex decomposition and simplification of polygons.

use crate::triangulation::{doubled_signed_area, orient2d, triangulate};
use nalgebra::Point2;

/// Approximate convex decomposition of a simple, counter-clockwise polygon, with concavities of
/// at most `tolerance`.
///
/// Triangles are merged greedily, smallest concavity first, as long as the concavity of the
/// merged piece is at most the tolerance. Each piece is a convex,
/// counter-clockwise polygon.
pub fn convex_decomposition(polygon: &[Point2<f32>], tolerance: f32) -> Vec<Vec<Point2<f32>>> {
    let mut pieces: Vec<Vec<usize>> = triangulate(polygon).into_iter().map(Vec::from).collect();
    let mut merges: Vec<MergeCandidate> = (1..pieces.len())
        .flat_map(|b| (0..b).map(move |a| (a, b)))
        .filter_map(|(a, b)| MergeCandidate::of(polygon, &pieces, a, b))
        .collect();
    while let Some(&MergeCandidate { a, b, .. }) = shallowest(&merges, tolerance) {
        let absorbed = std::mem::take(&mut pieces[b]);
        for i in absorbed {
            if !pieces[a].contains(&i) {
                pieces[a].push(i);
            }
        }
        merges.retain(|merge| ![merge.a, merge.b].iter().any(|i| *i == a || *i == b));
        let anew = (0..pieces.len()).filter(|&other| other != a);
        merges.extend(anew.filter_map(|other| MergeCandidate::of(polygon, &pieces, a, other)));
    }
    let hulls = pieces.iter().map(|piece| convex_hull(polygon, piece));
    hulls
        .filter(|hull| hull.len() > 2)
        .map(|hull| hull.into_iter().map(|i| polygon[i]).collect())
        .collect()
}

/// Pair of neighbouring pieces with the concavity of their common hull.
struct MergeCandidate {
    depth: f32,
    a: usize,
    b: usize,
}

impl MergeCandidate {
    /// Creates a candidate; `None` for pieces without a common edge.
    fn of(polygon: &[Point2<f32>], pieces: &[Vec<usize>], a: usize, b: usize) -> Option<Self> {
        let n_shared = pieces[a].iter().filter(|i| pieces[b].contains(i)).count();
        (n_shared >= 2).then(|| Self {
            depth: concavity(polygon, &pieces[a], &pieces[b]),
            a,
            b,
        })
    }
}

fn shallowest(merges: &[MergeCandidate], tolerance: f32) -> Option<&MergeCandidate> {
    merges
        .iter()
        .filter(|merge| merge.depth <= tolerance)
        .min_by(|a, b| a.depth.total_cmp(&b.depth))
}

/// Concavity of the union of two pieces: depth of the outline below an edge of the common hull.
fn concavity(polygon: &[Point2<f32>], a: &[usize], b: &[usize]) -> f32 {
    let n = polygon.len();
    let both: Vec<usize> = a.iter().chain(b).copied().collect();
    let hull = convex_hull(polygon, &both);
    let mut deepest = 0.0_f32;
    for (k, &from) in hull.iter().enumerate() {
        let to = hull[(k + 1) % hull.len()];
        // Corners along the outline between the edge's ends bound its concavity.
        let ahead = |i: usize| (i + n - from) % n;
        let along = (polygon[to] - polygon[from]).norm();
        for &i in both.iter().filter(|&&i| ahead(i) < ahead(to)) {
            deepest = deepest.max(orient2d(polygon[from], polygon[to], polygon[i]) / along);
        }
    }
    deepest
}

/// Convex hull, counter-clockwise, by the monotone chain (Andrew 1979).
fn convex_hull(polygon: &[Point2<f32>], indices: &[usize]) -> Vec<usize> {
    let mut sorted = indices.to_vec();
    sorted.sort_by(|&i, &k| {
        let (p, q) = (polygon[i], polygon[k]);
        p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
    });
    sorted.dedup_by(|i, k| polygon[*i] == polygon[*k]);
    let chain = |indices: &mut dyn Iterator<Item = usize>| {
        let mut chain: Vec<usize> = Vec::new();
        for i in indices {
            while let [.., a, b] = chain[..]
                && orient2d(polygon[a], polygon[b], polygon[i]) <= 0.0
            {
                chain.pop();
            }
            chain.push(i);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut sorted.iter().copied());
    hull.extend(chain(&mut sorted.iter().rev().copied()));
    hull
}

/// Polygon simplification (Ramer 1972; Douglas and Peucker 1973): no removed corner is farther
/// than `tolerance` from the result. Counter-clockwise.
pub fn simplify_polygon(polygon: &[Point2<f32>], tolerance: f32) -> Vec<Point2<f32>> {
    let Some(&first) = polygon.first() else {
        return Vec::new();
    };
    let far = |i: &usize| (polygon[*i] - first).norm();
    let middle = (0..polygon.len())
        .max_by(|a, b| far(a).total_cmp(&far(b)))
        .unwrap_or(0);
    let mut closed = polygon.to_vec();
    closed.push(first);
    let mut kept = vec![0];
    douglas_peucker(&closed, 0, middle, tolerance, &mut kept);
    douglas_peucker(&closed, middle, polygon.len(), tolerance, &mut kept);
    kept.pop();
    let mut simple: Vec<_> = kept.into_iter().map(|i| closed[i]).collect();
    if doubled_signed_area(&simple) < 0.0 {
        simple.reverse();
    }
    simple
}

/// Recursive step of the simplification: appends the corners to keep in the range after `from`
/// up to and including `to`.
fn douglas_peucker(
    points: &[Point2<f32>],
    from: usize,
    to: usize,
    tolerance: f32,
    kept: &mut Vec<usize>,
) {
    let (a, b) = (points[from], points[to]);
    let distance = |i: &usize| {
        let along = b - a;
        let share = (points[*i] - a).dot(&along) / along.norm_squared().max(f32::MIN_POSITIVE);
        (points[*i] - a - along * share.clamp(0.0, 1.0)).norm()
    };
    let farthest = (from + 1..to).max_by(|i, k| distance(i).total_cmp(&distance(k)));
    match farthest {
        Some(i) if distance(&i) > tolerance => {
            douglas_peucker(points, from, i, tolerance, kept);
            douglas_peucker(points, i, to, tolerance, kept);
        }
        _ => {
            if to > from {
                kept.push(to);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(r: f32, reversed: bool) -> Vec<Point2<f32>> {
        let mut arc: Vec<_> = (0..=40)
            .map(|i| (i as f32 / 40.0 * std::f32::consts::PI).sin_cos())
            .map(|(sin, cos)| Point2::new(r * cos, r * sin))
            .collect();
        if reversed {
            arc.reverse();
        }
        arc
    }

    #[test]
    fn an_arch_falls_into_few_pieces_that_keep_its_opening() {
        let mut arch = arc(0.05, false);
        arch.extend(arc(0.045, true));
        let arch = simplify_polygon(&arch, 0.0005);
        let pieces = convex_decomposition(&arch, 0.003);
        assert!((3..=8).contains(&pieces.len()), "{}", pieces.len());
        let covered = |p: Point2<f32>| {
            pieces.iter().any(|piece| {
                (0..piece.len())
                    .all(|i| orient2d(piece[i], piece[(i + 1) % piece.len()], p) >= -1e-9)
            })
        };
        assert!(!covered(Point2::new(0.0, 0.03)));
        assert!(covered(Point2::new(0.0, 0.0475)));
    }

    #[test]
    fn a_convex_polygon_is_one_piece() {
        let half_disc = arc(1.0, false);
        assert_eq!(convex_decomposition(&half_disc, 1e-4).len(), 1);
        assert!(simplify_polygon(&half_disc, 0.01).len() < 20);
    }
}
