//! The fast test whether a point lies over the table.

use geometry::ConvexPolygon;
use nalgebra::Point2;

/// Slabs the polygon is cut into: 1 cm each for a table of 2.5 m.
const N_SLABS: usize = 256;

/// A convex polygon grown by a margin, cut into slabs along u. Between two
/// cuts its borders run straight, which rounds a corner by less than a
/// millimetre.
#[derive(Debug, Clone)]
pub(crate) struct TableSlabs {
    u_min: f32,
    slabs_per_m: f32,
    /// Lower and upper border along v at each cut; lower > upper outside.
    cuts: Vec<[f32; 2]>,
}

impl Default for TableSlabs {
    fn default() -> Self {
        Self {
            u_min: 0.0,
            slabs_per_m: 0.0,
            cuts: vec![[1.0, 0.0]; N_SLABS + 1],
        }
    }
}

impl TableSlabs {
    /// Cuts a polygon, every edge moved outwards by `margin_m`.
    pub(crate) fn refill(&mut self, polygon: &ConvexPolygon, margin_m: f64) {
        let corners = polygon.corners();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for corner in corners {
            (low, high) = (low.min(corner.x - margin_m), high.max(corner.x + margin_m));
        }
        let slab_m = ((high - low) / N_SLABS as f64).max(1e-6);
        self.u_min = low as f32;
        self.slabs_per_m = (1.0 / slab_m) as f32;
        for (i, cut) in self.cuts.iter_mut().enumerate() {
            *cut = cut_at(corners, low + i as f64 * slab_m, margin_m);
        }
    }

    /// Whether a point of the table's frame lies inside.
    #[inline]
    pub(crate) fn contains(&self, u: f32, v: f32) -> bool {
        let along = (u - self.u_min) * self.slabs_per_m;
        if !(0.0..N_SLABS as f32).contains(&along) {
            return false;
        }
        let slab = along as usize;
        let part = along - slab as f32;
        let (from, to) = (self.cuts[slab], self.cuts[slab + 1]);
        let at = |i: usize| from[i] + part * (to[i] - from[i]);
        (at(0) <= v) & (v <= at(1))
    }
}

/// Where the line at `u` enters and leaves the grown polygon.
fn cut_at(corners: &[Point2<f64>], u: f64, margin_m: f64) -> [f32; 2] {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let along = b - a;
        let length = along.norm();
        // Inside is where along.x * (v - a.y) - along.y * (u - a.x) >= -margin * length.
        let right = along.y * (u - a.x) - margin_m * length;
        if along.x > 1e-9 * length {
            low = low.max(a.y + right / along.x);
        } else if along.x < -1e-9 * length {
            high = high.min(a.y + right / along.x);
        } else if right > 0.0 {
            return [1.0, 0.0];
        }
    }
    if low <= high {
        [low as f32, high as f32]
    } else {
        [1.0, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn slabs_agree_with_the_polygon_away_from_its_border(
            mut corners in prop::collection::vec((-1.0..1.0, -1.0..1.0).prop_map(|(x, y)| Point2::new(x, y)), 3..20),
            probes in prop::collection::vec((-1.2..1.2, -1.2..1.2), 50),
            margin in 0.0..0.1,
        ) {
            let polygon = ConvexPolygon::hull_of(&mut corners);
            prop_assume!(polygon.corners().len() >= 3 && polygon.area_m2() > 0.05);
            let mut slabs = TableSlabs::default();
            slabs.refill(&polygon, margin);
            let ends = polygon.corners().iter().map(|corner| corner.x);
            let (low, high) = ends.fold((f64::MAX, f64::MIN), |(l, h), u| (l.min(u), h.max(u)));
            for (u, v) in probes {
                let (u, v): (f64, f64) = (u, v);
                // A pointed corner is cut off at the margin before its tip.
                let before_end = (u - low).min(high - u) + margin;
                let inner = polygon.inner_distance_m(&Point2::new(u, v)) + margin;
                if inner.abs() > 0.012 && before_end.abs() > 0.02 {
                    let expected = inner > 0.0 && before_end > 0.0;
                    prop_assert_eq!(slabs.contains(u as f32, v as f32), expected);
                }
            }
        }
    }

    #[test]
    fn nothing_lies_over_an_empty_polygon() {
        let mut slabs = TableSlabs::default();
        slabs.refill(&ConvexPolygon::default(), 0.0);
        assert!(!slabs.contains(0.0, 0.0) && !slabs.contains(f32::NAN, 0.0));
    }
}
