//! Boundary statistics of two adjacent regions; sums, so that boundaries can be added.

use crate::affine_form::AffineForm;
use crate::patch::Patch;

/// Greatest depth step within one surface, metres at 1 m, growing with squared depth.
/// Across a larger step the continuation of the surface is unknown. Chosen; sensitivity:
/// see `tabula-lab sweep`.
const STEP_M: f32 = 0.006;

/// Least bend of a concave boundary, and of a convex one with the other sign, metres per
/// metre on either side. Chosen; sensitivity: see `tabula-lab sweep`.
const BEND_MIN: f32 = 0.4;

/// Greatest bend that counts, metres per metre.
const BEND_MAX: f32 = 2.0;

/// Greatest depth step that counts, metres at 1 m.
const STEP_MAX_M: f32 = 0.05;

/// Distance of the pixels compared in colour from the boundary, pixels.
const COLOR_PX: isize = 3;

/// Boundary pair: two neighbouring pixels of different regions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct BoundaryPair {
    /// Pair of adjacent regions, lower number first.
    pub(super) regions: [u32; 2],
    /// Their pixels, as patch indices.
    pub(super) pixels: [u32; 2],
}

/// Boundary statistics of two adjacent regions.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct RegionBoundary {
    /// Pair of adjacent regions, lower number first.
    pub(super) regions: [u32; 2],
    pub(super) n_pairs: u32,
    pub(super) n_unknown: u32,
    pub(super) n_concave: u32,
    pub(super) n_convex: u32,
    /// Sum of the known bends, metres per metre.
    pub(super) bend: f32,
    /// Sum of the depth steps, metres at 1 m.
    pub(super) step_m: f32,
    /// Sum of the heights over the table, metres, and of their squares.
    pub(super) height_m: f32,
    pub(super) height_squares_m2: f32,
    /// Sum of the colour differences across the boundary, 0 to 255 per channel.
    pub(super) color_step: f32,
}

impl RegionBoundary {
    /// Statistics of all pairs of two regions, which must not be empty. `bend` holds the
    /// signed bend at each pixel of the patch.
    pub(super) fn of(
        pairs: &[BoundaryPair],
        patch: &Patch,
        bend: &[f32],
        height: &AffineForm,
    ) -> Self {
        let mut boundary = Self {
            regions: pairs[0].regions,
            n_pairs: pairs.len() as u32,
            ..Self::default()
        };
        for pair in pairs {
            boundary.add_pair(pair, patch, bend, height);
        }
        boundary
    }

    fn add_pair(&mut self, pair: &BoundaryPair, patch: &Patch, bend: &[f32], height: &AffineForm) {
        let [a, b] = pair.pixels.map(|pixel| pixel as usize);
        // The nearer surface ends at the boundary; the farther one may go on behind it.
        let nearer = [a, b].map(|pixel| &patch.points[pixel]);
        let nearer = if nearer[0].z <= nearer[1].z {
            nearer[0]
        } else {
            nearer[1]
        };
        let height_m = height.at(nearer.x, nearer.y, nearer.z);
        self.height_m += height_m;
        self.height_squares_m2 += height_m * height_m;
        let depth = [a, b].map(|pixel| patch.points[pixel].z);
        let step_m = (depth[0] - depth[1]).abs() / (depth[0] * depth[0]);
        let bend = bend[a].max(bend[b]);
        self.step_m += step_m.min(STEP_MAX_M);
        self.color_step += color_step(pair, patch);
        if bend.is_nan() || step_m > STEP_M {
            self.n_unknown += 1;
        } else {
            self.n_concave += u32::from(bend > BEND_MIN);
            self.n_convex += u32::from(bend < -BEND_MIN);
            self.bend += bend.clamp(-BEND_MAX, BEND_MAX);
        }
    }

    /// Add the statistics of another boundary between the same regions.
    pub(super) fn add(&mut self, other: &Self) {
        self.n_pairs += other.n_pairs;
        self.n_unknown += other.n_unknown;
        self.n_concave += other.n_concave;
        self.n_convex += other.n_convex;
        self.bend += other.bend;
        self.step_m += other.step_m;
        self.height_m += other.height_m;
        self.height_squares_m2 += other.height_squares_m2;
        self.color_step += other.color_step;
    }
}

/// Colour difference across a boundary, mean of the channels, 0 to 255: of the pixels a
/// little to either side, or at the boundary where a region is narrower.
fn color_step(pair: &BoundaryPair, patch: &Patch) -> f32 {
    let [a, b] = pair.pixels.map(|pixel| pixel as usize);
    let step = b as isize - a as isize;
    let far = |from: usize, steps: isize| {
        let at = from.wrapping_add_signed(steps * step);
        let is_same = patch.part_of.get(at) == Some(&patch.part_of[from]);
        let place = if is_same { at } else { from };
        patch.points[place].color.rgb()
    };
    let (left, right) = (far(a, -COLOR_PX), far(b, COLOR_PX));
    let differences = left
        .into_iter()
        .zip(right)
        .map(|(a, b)| f32::from(a.abs_diff(b)));
    differences.sum::<f32>() / 3.0
}
