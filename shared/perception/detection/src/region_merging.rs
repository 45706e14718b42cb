//! Region merging: logistic decision on whether adjacent regions of a cluster are one
//! object.

use crate::cielab::ColorSum;
use point_cloud::Point;

/// Greatest depth step within one surface, metres at 1 m, growing with squared depth.
/// Across a larger step the continuation of the surface is unknown. Chosen; sensitivity:
/// see `tabula-lab sweep`.
const STEP_M: f32 = 0.006;

/// Least bend of a concave boundary, metres per metre on either side. Chosen; sensitivity:
/// see `tabula-lab sweep`.
const CONCAVE_MIN: f32 = 0.4;

/// Saturation of the colour difference ΔE. Chosen; sensitivity: see `tabula-lab sweep`.
const COLOR_DIFFERENCE_MAX: f32 = 50.0;

/// Weights of the log odds that two regions are one object. Logistic regression over the
/// boundaries in simulated piles and in the even scenes of mOSD `learn`, rounded; the
/// constant is then lowered by 0.7, because merging two objects is worse than splitting
/// one.
mod weights {
    /// Constant term of the log odds.
    pub(super) const CONSTANT: f32 = 2.15;
    /// Weight of the share of the boundary with unknown continuation: a depth step or too
    /// narrow to measure.
    pub(super) const UNKNOWN: f32 = -1.9;
    /// Weight of the concave share of the boundary.
    pub(super) const CONCAVE: f32 = -1.25;
    /// Weight per unit of colour difference ΔE between the regions (CIE 1976).
    pub(super) const COLOR: f32 = -0.038;
    /// Weight of the logarithm of the smaller area, in thousands of pixels at 1 m: large
    /// regions seldom belong together.
    pub(super) const SMALLER_AREA: f32 = -0.8;
    /// Weight of the logarithm of the larger area, in thousands of pixels at 1 m.
    pub(super) const LARGER_AREA: f32 = -0.35;
    /// Weight of the logarithm of the boundary's length over the square root of the smaller
    /// area.
    pub(super) const LENGTH: f32 = 0.6;
}

/// Boundary pair: two neighbouring pixels of different regions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct BoundaryPair {
    /// Pair of adjacent regions, lower number first.
    regions: [u32; 2],
    pixels: [u32; 2],
}

/// Boundary statistics of two adjacent regions; sums, so that boundaries can be added.
#[derive(Debug, Clone, Copy)]
struct RegionBoundary {
    /// Pair of adjacent regions, lower number first.
    regions: [u32; 2],
    n_pairs: u32,
    n_unknown: u32,
    n_concave: u32,
}

/// Region statistics: colour and area.
#[derive(Debug, Clone, Copy, Default)]
struct RegionSums {
    color: ColorSum,
    /// Area as the number of pixels it would have at 1 m.
    n_pixels_at_1m: f32,
}

/// Region adjacency graph with the pixel pairs along all boundaries. Reused from frame to
/// frame.
#[derive(Debug, Default)]
pub(crate) struct RegionAdjacency {
    pairs: Vec<BoundaryPair>,
    boundaries: Vec<RegionBoundary>,
    regions: Vec<RegionSums>,
}

impl RegionAdjacency {
    /// Reset to `n_parts` empty regions, counted from 0.
    pub(crate) fn clear(&mut self, n_parts: usize) {
        self.pairs.clear();
        self.regions.clear();
        self.regions.resize(n_parts, RegionSums::default());
    }

    /// Adds a pixel to its region.
    #[inline]
    pub(crate) fn add_pixel(&mut self, region: u32, point: &Point) {
        let sums = &mut self.regions[region as usize];
        sums.color.add(point.color.rgb());
        sums.n_pixels_at_1m += point.z * point.z;
    }

    /// Add a pair of neighbouring pixels of different regions.
    #[inline]
    pub(crate) fn add_pair(&mut self, regions: [u32; 2], pixels: [usize; 2]) {
        let [a, b] = pixels.map(|pixel| pixel as u32);
        self.pairs.push(if regions[0] < regions[1] {
            BoundaryPair {
                regions,
                pixels: [a, b],
            }
        } else {
            BoundaryPair {
                regions: [regions[1], regions[0]],
                pixels: [b, a],
            }
        });
    }

    /// Greedy region merging: call `join(target, source)` for each two regions that are one
    /// object, most certain first, and update the graph after each merge. `points` and
    /// `bend` hold the point and the signed bend at each pixel.
    pub(crate) fn merge_regions(
        &mut self,
        points: &[Point],
        bend: &[f32],
        mut join: impl FnMut(u32, u32),
    ) {
        self.pairs.sort_unstable();
        self.boundaries.clear();
        let boundaries = self.pairs.chunk_by(|a, b| a.regions == b.regions);
        self.boundaries
            .extend(boundaries.map(|pairs| RegionBoundary::of(pairs, points, bend)));
        while let Some(at) = self.most_certain() {
            let [target, source] = self.boundaries.swap_remove(at).regions;
            join(target, source);
            self.merge(target, source);
        }
    }

    /// Boundary with the highest log odds; `None` when no two regions are one object.
    fn most_certain(&self) -> Option<usize> {
        let odds = self
            .boundaries
            .iter()
            .map(|boundary| self.log_odds(boundary));
        let (at, odds) = odds.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        (odds > 0.0).then_some(at)
    }

    /// Log odds that the regions of a boundary are one object.
    fn log_odds(&self, boundary: &RegionBoundary) -> f32 {
        let [a, b] = boundary
            .regions
            .map(|region| &self.regions[region as usize]);
        let share = |n: u32| n as f32 / boundary.n_pairs as f32;
        let delta_e = a.color.mean().delta_e(&b.color.mean());
        let areas = [a, b].map(|region| region.n_pixels_at_1m.max(1.0));
        let (smaller, larger) = (areas[0].min(areas[1]), areas[0].max(areas[1]));
        weights::CONSTANT
            + weights::UNKNOWN * share(boundary.n_unknown)
            + weights::CONCAVE * share(boundary.n_concave)
            + weights::COLOR * delta_e.min(COLOR_DIFFERENCE_MAX)
            + weights::SMALLER_AREA * (smaller / 1000.0).ln()
            + weights::LARGER_AREA * (larger / 1000.0).ln()
            + weights::LENGTH * (boundary.n_pairs as f32 / smaller.sqrt()).ln()
    }

    /// Merge two regions, and their boundaries to a common third region.
    fn merge(&mut self, target: u32, source: u32) {
        let gone = self.regions[source as usize];
        let kept = &mut self.regions[target as usize];
        kept.color.merge(&gone.color);
        kept.n_pixels_at_1m += gone.n_pixels_at_1m;
        for boundary in &mut self.boundaries {
            for region in boundary
                .regions
                .iter_mut()
                .filter(|region| **region == source)
            {
                *region = target;
            }
            boundary.regions.sort_unstable();
        }
        self.boundaries
            .sort_unstable_by_key(|boundary| boundary.regions);
        self.boundaries.dedup_by(|next, first| {
            let same = next.regions == first.regions;
            if same {
                first.add(next);
            }
            same
        });
    }
}

impl RegionBoundary {
    fn of(pairs: &[BoundaryPair], points: &[Point], bend: &[f32]) -> Self {
        let mut boundary = Self {
            regions: pairs[0].regions,
            n_pairs: pairs.len() as u32,
            n_unknown: 0,
            n_concave: 0,
        };
        for pair in pairs {
            let [a, b] = pair.pixels.map(|pixel| points[pixel as usize].z);
            let bend = pair.pixels.map(|pixel| bend[pixel as usize]);
            let bend = bend[0].max(bend[1]);
            let is_unknown = bend.is_nan() || (a - b).abs() > STEP_M * a * a;
            boundary.n_unknown += u32::from(is_unknown);
            boundary.n_concave += u32::from(!is_unknown && bend > CONCAVE_MIN);
        }
        boundary
    }

    fn add(&mut self, other: &Self) {
        self.n_pairs += other.n_pairs;
        self.n_unknown += other.n_unknown;
        self.n_concave += other.n_concave;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use point_cloud::Rgba;

    const WIDTH: usize = 150;
    const HEIGHT: usize = 60;

    /// Merges of three regions in a row, each 50 columns wide, at 1 m; `bends` and
    /// `steps_m` apply to their two boundaries.
    fn joined(bends: [f32; 2], steps_m: [f32; 2], colors: [[u8; 3]; 3]) -> Vec<(u32, u32)> {
        let region = |i: usize| i % WIDTH / 50;
        let depth = |region: usize| 1.0 + steps_m[..region].iter().sum::<f32>();
        let points: Vec<Point> = (0..WIDTH * HEIGHT)
            .map(|i| {
                let [red, green, blue] = colors[region(i)];
                Point {
                    x: 0.0,
                    y: 0.0,
                    z: depth(region(i)),
                    color: Rgba::opaque(red, green, blue),
                }
            })
            .collect();
        let mut bend = vec![0.0; points.len()];
        let mut boundaries = RegionAdjacency::default();
        boundaries.clear(3);
        for (i, point) in points.iter().enumerate() {
            boundaries.add_pixel(region(i) as u32, point);
            if i % WIDTH == 49 || i % WIDTH == 99 {
                bend[i..=i + 1].fill(bends[region(i)]);
                boundaries.add_pair([region(i + 1) as u32, region(i) as u32], [i + 1, i]);
            }
        }
        let mut joined = Vec::new();
        boundaries.merge_regions(&points, &bend, |a, b| joined.push((a, b)));
        joined
    }

    const GREY: [u8; 3] = [128; 3];
    const RED: [u8; 3] = [220, 30, 30];

    #[test]
    fn smooth_boundaries_within_one_color_merge() {
        assert_eq!(joined([0.0; 2], [0.0; 2], [GREY; 3]).len(), 2);
    }

    #[test]
    fn crease_depth_step_or_unknown_bend_prevents_merging() {
        assert_eq!(joined([1.0, 0.0], [0.0; 2], [GREY; 3]), [(1, 2)]);
        assert_eq!(joined([0.0; 2], [0.0, 0.02], [GREY; 3]), [(0, 1)]);
        assert_eq!(joined([f32::NAN, 0.0], [0.0; 2], [GREY; 3]), [(1, 2)]);
    }

    #[test]
    fn color_difference_prevents_merging() {
        assert_eq!(joined([0.0; 2], [0.0; 2], [GREY, GREY, RED]), [(0, 1)]);
    }
}
