//! Features of an edge of the cell image: two neighbouring cells, which may be of two objects.
//!
//! The features of a block of edges are computed together, feature by feature, so that the
//! compiler vectorises them.

use super::bends::Bends;
use super::cell_image::CellImage;
use crate::clusters::NO_CLUSTER;
use sensor_noise::DepthNoise;
use std::array::from_fn;

/// Number of edges of a block.
pub(super) const BLOCK: usize = 16;

/// Number of features of an edge.
pub const N_EDGE_FEATURES: usize = 16;

/// Features of an edge, in the order of [`EDGE_FEATURE_NAMES`].
pub type EdgeFeatures = [f32; N_EDGE_FEATURES];

/// Names of the features.
pub const EDGE_FEATURE_NAMES: [&str; N_EDGE_FEATURES] = [
    "root of the depth step at 1 m, in 4 mm",
    "greater bend of both cells along the line of the edge, metres per metre",
    "smaller bend of both cells along the line, metres per metre",
    "greater bend of both cells across the line, metres per metre",
    "change of slope over one cell on either side, metres per metre",
    "change of slope over two cells",
    "change of slope over four cells",
    "number of these changes that are not known",
    "lightness step between the cells, 0 to 1",
    "colour step between the cells",
    "lightness step between the second to fourth cells on either side",
    "colour step between the second to fourth cells",
    "texture: mean lightness step within either side",
    "noise of the slope between neighbouring cells, metres per metre",
    "greater slope of both sides, metres per metre",
    "smaller slope of both sides, metres per metre",
];

/// Features of a block of edges, feature by feature.
pub(super) type EdgeBlock = [[f32; BLOCK]; N_EDGE_FEATURES];

/// Greatest slope and bend that count, metres per metre.
const SLOPE_MAX: f32 = 3.0;

/// Unit of the depth step, metres at 1 m.
const STEP_M: f32 = 0.004;

/// Greatest root of a depth step.
const STEP_MAX: f32 = 4.0;

/// Cells before the first cell of an edge that its features use.
const N_BEFORE: usize = 4;

/// Cells of the line of an edge that its features use: the last is four beyond the second cell.
const N_LINE: usize = 2 * N_BEFORE + 2;

/// Cells whose means are compared as the surroundings of an edge, on either side.
const SURROUNDINGS: [[usize; 3]; 2] = [[1, 2, 3], [6, 7, 8]];

/// Edges along one axis of a cell image.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeLines<'a> {
    image: &'a CellImage,
    bends_along: &'a [f32],
    bends_across: &'a [f32],
    /// Distance of the two cells of an edge in the arrays of the image.
    pub(super) step: usize,
    /// Width of a cell, metres at 1 m.
    pitch: f32,
    noise: DepthNoise,
}

impl<'a> EdgeLines<'a> {
    /// Edges between neighbours in a row, and those between neighbours in a column.
    pub(super) fn of(
        image: &'a CellImage,
        bends: &'a Bends,
        pitch: f32,
        noise: DepthNoise,
    ) -> [Self; 2] {
        let rows = Self {
            image,
            bends_along: &bends.along_row,
            bends_across: &bends.along_column,
            step: 1,
            pitch,
            noise,
        };
        let columns = Self {
            bends_along: &bends.along_column,
            bends_across: &bends.along_row,
            step: image.width,
            ..rows
        };
        [rows, columns]
    }

    /// `true` for each of a block of places from `first` on that holds a cell, as the next place
    /// on the line does, unless both are of one cluster that `is_whole`.
    #[inline]
    pub(super) fn mask(&self, first: usize, is_whole: &[bool]) -> [bool; BLOCK] {
        let here = block(&self.image.cluster_of, first);
        let next = block(&self.image.cluster_of, first + self.step);
        from_fn(|i| {
            here[i] != NO_CLUSTER
                && next[i] != NO_CLUSTER
                && !(here[i] == next[i] && is_whole[here[i] as usize])
        })
    }

    /// Features of the edges from a block of places to the next ones on the line; meaningless
    /// where there is no edge.
    #[inline]
    pub(super) fn features(&self, first: usize) -> EdgeBlock {
        let inverse_depth = self.line(&self.image.inverse_depth, first);
        let mut features = [[0.0; BLOCK]; N_EDGE_FEATURES];
        self.add_bends(first, &mut features);
        self.add_slopes(&inverse_depth, &mut features);
        self.add_colors(first, &inverse_depth, &mut features);
        features
    }

    /// Blocks of values along the lines of a block of edges; the first cell of an edge is at
    /// [`N_BEFORE`].
    #[inline]
    fn line<'b>(&self, values: &'b [f32], first: usize) -> [&'b [f32; BLOCK]; N_LINE] {
        from_fn(|k| block(values, first + k * self.step - N_BEFORE * self.step))
    }

    #[inline]
    fn add_bends(&self, first: usize, features: &mut EdgeBlock) {
        let bend = |bends: &'a [f32]| [first, first + self.step].map(|at| block(bends, at));
        let (along, across) = (bend(self.bends_along), bend(self.bends_across));
        for i in 0..BLOCK {
            features[1][i] = known(along[0][i].max(along[1][i]));
            features[2][i] = known(along[0][i].min(along[1][i]));
            features[3][i] = known(across[0][i].max(across[1][i]));
        }
    }

    #[inline]
    fn add_slopes(&self, inverse_depth: &[&[f32; BLOCK]; N_LINE], features: &mut EdgeBlock) {
        for i in 0..BLOCK {
            let at = |k: usize| inverse_depth[k][i];
            let (own, next) = (at(N_BEFORE), at(N_BEFORE + 1));
            let depth_m = 1.0 / own.max(0.05);
            // Slope of a difference of inverse depth between neighbours.
            let slope = depth_m / self.pitch;
            let step_m = (next - own).abs() * own / next.max(0.05);
            features[0][i] = (step_m / STEP_M).sqrt().min(STEP_MAX);
            for (feature, n) in [(4, 1), (5, 2), (6, 4)] {
                let (before, beyond) = (at(N_BEFORE - n), at(N_BEFORE + 1 + n));
                let change = ((beyond - next) - (own - before)) * slope / n as f32;
                let is_known = before.min(beyond) > 0.0;
                features[feature][i] = if is_known { bounded(change) } else { 0.0 };
                features[7][i] += if is_known { 0.0 } else { 1.0 };
            }
            let (before, beyond) = (at(N_BEFORE - 3), at(N_BEFORE + 4));
            let left = if before > 0.0 { own - before } else { 0.0 };
            let right = if beyond > 0.0 { beyond - next } else { 0.0 };
            let [left, right] = [left, right].map(|change| bounded(change * slope / 3.0));
            features[13][i] = self.noise.sigma_m(depth_m) * own / self.pitch;
            features[14][i] = left.max(right);
            features[15][i] = left.min(right);
        }
    }

    #[inline]
    fn add_colors(
        &self,
        first: usize,
        inverse_depth: &[&[f32; BLOCK]; N_LINE],
        features: &mut EdgeBlock,
    ) {
        let is_cell: [[f32; BLOCK]; N_LINE] =
            from_fn(|k| from_fn(|i| if inverse_depth[k][i] > 0.0 { 1.0 } else { 0.0 }));
        let n_cells = SURROUNDINGS
            .map(|side| from_fn::<_, BLOCK, _>(|i| side.iter().map(|&k| is_cell[k][i]).sum()));
        for (channel, values) in self.image.colors.iter().enumerate() {
            let values = self.line(values, first);
            let [near, far] = if channel == 0 { [8, 10] } else { [9, 11] };
            for i in 0..BLOCK {
                features[near][i] += (values[N_BEFORE][i] - values[N_BEFORE + 1][i]).abs();
                // Without a cell a value is 0.
                let sums = SURROUNDINGS.map(|side| side.iter().map(|&k| values[k][i]).sum());
                let n: [f32; 2] = [n_cells[0][i], n_cells[1][i]];
                let mean = |side: usize, sums: &[f32; 2]| sums[side] / n[side].max(1.0);
                features[far][i] +=
                    (mean(0, &sums) - mean(1, &sums)).abs() * (n[0] * n[1]).min(1.0);
            }
            if channel == 0 {
                for [k, next] in [[1, 2], [2, 3], [3, 4], [5, 6], [6, 7], [7, 8]] {
                    for i in 0..BLOCK {
                        let step = (values[k][i] - values[next][i]).abs();
                        features[12][i] += step * is_cell[k][i] * is_cell[next][i] / 6.0;
                    }
                }
            }
        }
    }
}

/// Slope within the limits.
#[inline]
fn bounded(slope: f32) -> f32 {
    slope.clamp(-SLOPE_MAX, SLOPE_MAX)
}

/// Bend within the limits; 0 for one that was not measured.
#[inline]
fn known(bend: f32) -> f32 {
    if bend.is_nan() { 0.0 } else { bounded(bend) }
}

#[inline]
fn block<T>(values: &[T], first: usize) -> &[T; BLOCK] {
    let (blocks, _) = values[first..].as_chunks::<BLOCK>();
    &blocks[0]
}
