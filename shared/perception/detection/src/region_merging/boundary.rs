//! Boundary statistics of two adjacent regions; sums, so that boundaries can be added.

use crate::segmentation::{Bends, Cell, CellImage, NO_EDGE, log_odds_of};

/// Greatest depth step within one surface, metres at 1 m, growing with squared depth.
/// Across a larger step the continuation of the surface is unknown. Chosen.
const STEP_M: f32 = 0.009;

/// Least bend of a concave boundary, and of a convex one with the other sign, metres per
/// metre on either side. Chosen.
const BEND_MIN: f32 = 0.4;

/// Greatest bend that counts, metres per metre.
const BEND_MAX: f32 = 2.0;

/// Greatest depth step that counts, metres at 1 m.
const STEP_MAX_M: f32 = 0.05;

/// Distance of the cells compared in colour from the boundary, cells.
const COLOR_CELLS: isize = 2;

/// Cells over whose boundary regions are compared, and what is known of the cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoundaryImage<'a> {
    pub(super) image: &'a CellImage,
    pub(super) bends: &'a Bends,
    /// Per cell: the number of its region.
    pub(super) region_of: &'a [u32],
    /// Per cell: the height over the table, metres.
    pub(super) height_m: &'a [f32],
}

/// Boundary pair: two neighbouring cells of different regions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct BoundaryPair {
    /// Pair of adjacent regions, lower number first.
    pub(super) regions: [u32; 2],
    /// Numbers of their cells, in the order of the image.
    pub(super) cells: [u32; 2],
    /// Strength of the edge between the cells; [`NO_EDGE`] across a gap.
    pub(super) strength: u8,
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
    /// Sum of the log odds of the edges.
    pub(super) log_odds: f32,
    /// Number of pairs across a gap without depth.
    pub(super) n_gaps: u32,
}

impl RegionBoundary {
    /// Statistics of all pairs of two regions, which must not be empty.
    pub(super) fn of(pairs: &[BoundaryPair], cells: &BoundaryImage<'_>) -> Self {
        let mut boundary = Self {
            regions: pairs[0].regions,
            n_pairs: pairs.len() as u32,
            ..Self::default()
        };
        for pair in pairs {
            boundary.add_pair(pair, cells);
        }
        boundary
    }

    fn add_pair(&mut self, pair: &BoundaryPair, cells: &BoundaryImage<'_>) {
        let numbers = pair.cells.map(|cell| cell as usize);
        let [a, b] = numbers.map(|number| &cells.image.cells[number]);
        // The nearer surface ends at the boundary; the farther one may go on behind it.
        let nearer = numbers[usize::from(a.depth_m > b.depth_m)];
        let height_m = cells.height_m[nearer];
        self.height_m += height_m;
        self.height_squares_m2 += height_m * height_m;
        let step_m = (a.depth_m - b.depth_m).abs() / (a.depth_m * a.depth_m);
        self.step_m += step_m.min(STEP_MAX_M);
        self.color_step += color_step([a, b].map(|cell| cell.place as usize), cells);
        if pair.strength == NO_EDGE {
            self.n_gaps += 1;
        } else {
            self.log_odds += log_odds_of(pair.strength);
        }
        let bend = |cell: &Cell| {
            let place = cell.place as usize;
            cells.bends.along_row[place].max(cells.bends.along_column[place])
        };
        let bend = bend(a).max(bend(b));
        if bend.is_nan() || step_m > STEP_M {
            self.n_unknown += 1;
        } else {
            self.n_concave += u32::from(bend > BEND_MIN);
            self.n_convex += u32::from(bend < -BEND_MIN);
            self.bend += bend.clamp(-BEND_MAX, BEND_MAX);
        }
    }

    /// Mean log odds that the edges along the boundary are boundaries of objects; 0 without edges.
    pub(super) fn mean_log_odds(&self) -> f32 {
        self.log_odds / (self.n_pairs - self.n_gaps).max(1) as f32
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
        self.log_odds += other.log_odds;
        self.n_gaps += other.n_gaps;
    }
}

/// Colour difference across a boundary, 0 to 255 for a channel: of the cells a little to either
/// side, or at the boundary where a region is narrower.
fn color_step([a, b]: [usize; 2], cells: &BoundaryImage<'_>) -> f32 {
    let BoundaryImage {
        image, region_of, ..
    } = cells;
    let is_row = b - a < image.width;
    let step = if is_row { 1 } else { image.width as isize };
    let region = |place: usize| region_of.get(image.number_of[place] as usize);
    let far = |from: usize, steps: isize| {
        let place = from.wrapping_add_signed(steps * step);
        if region(place) == region(from) {
            place
        } else {
            from
        }
    };
    let (left, right) = (far(a, -COLOR_CELLS), far(b, COLOR_CELLS));
    let [lightness, red_green, yellow_blue] = image
        .colors
        .each_ref()
        .map(|values| (values[left] - values[right]).abs());
    255.0 * (lightness + 0.5 * (red_green + yellow_blue))
}
