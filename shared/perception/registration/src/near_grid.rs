//! Uniform grid over points: nearest neighbours within a fixed, small reach.

/// Maximum number of cells; a larger grid gets larger cells. Chosen: 16 MB.
const N_CELLS_MAX: usize = 1 << 22;

/// Points sorted by the cells of a uniform grid, x fastest, so that the points of two
/// neighbouring cells along x are contiguous. The cells are at least twice as long as the reach:
/// whatever is near a place is in the two by two by two cells around it.
#[derive(Debug)]
pub(crate) struct NearGrid {
    reach_m: f32,
    cell_m: f32,
    first: [f32; 3],
    n_cells: [usize; 3],
    /// Place of the first point of each cell, and the number of points.
    starts: Vec<u32>,
    /// Coordinates of the sorted points by axis; points at infinity fill the last lanes.
    coordinates: [Vec<f32>; 3],
}

/// Number of points compared at once.
const LANES: usize = 8;

impl NearGrid {
    /// Grid over points for searches within a reach, metres.
    pub(crate) fn new(points: &[[f32; 3]], reach_m: f32) -> Self {
        let bound = |pick: fn(f32, f32) -> f32, start: f32| -> [f32; 3] {
            std::array::from_fn(|axis| points.iter().map(|p| p[axis]).fold(start, pick))
        };
        let (first, last) = (
            bound(f32::min, f32::INFINITY),
            bound(f32::max, f32::NEG_INFINITY),
        );
        let mut cell_m = 2.0 * reach_m.max(f32::MIN_POSITIVE);
        let cells = |cell_m: f32| -> [usize; 3] {
            std::array::from_fn(|axis| ((last[axis] - first[axis]) / cell_m).max(0.0) as usize + 1)
        };
        while cells(cell_m)
            .iter()
            .try_fold(1_usize, |n, &side| n.checked_mul(side))
            .is_none_or(|n| n > N_CELLS_MAX)
        {
            cell_m *= 2.0;
        }
        let mut grid = Self {
            reach_m,
            cell_m,
            first,
            n_cells: cells(cell_m),
            starts: Vec::new(),
            coordinates: Default::default(),
        };
        grid.sort(points);
        grid
    }

    /// Reach of the searches, metres.
    pub(crate) fn reach_m(&self) -> f32 {
        self.reach_m
    }

    /// Counting sort of the points by their cells.
    fn sort(&mut self, points: &[[f32; 3]]) {
        let index = |point: &[f32; 3]| {
            let [x, y, z] = self.cell(*point, 0.0);
            (z * self.n_cells[1] + y) * self.n_cells[0] + x
        };
        let n_cells: usize = self.n_cells.iter().product();
        let mut starts = vec![0; n_cells + 1];
        for point in points {
            starts[index(point) + 1] += 1;
        }
        for cell in 0..n_cells {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        let mut coordinates = [(); 3].map(|()| vec![f32::INFINITY; points.len() + LANES]);
        for point in points {
            let place = &mut next[index(point)];
            for (values, value) in coordinates.iter_mut().zip(point) {
                values[*place as usize] = *value;
            }
            *place += 1;
        }
        (self.starts, self.coordinates) = (starts, coordinates);
    }

    /// Squared distance from a place to the nearest point, if it is within the reach.
    pub(crate) fn nearest_squared(&self, place: [f32; 3]) -> Option<f32> {
        let [low, high] = [-0.5, 0.5].map(|offset| self.cell(place, offset));
        let mut least = [f32::INFINITY; LANES];
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let row = (z * self.n_cells[1] + y) * self.n_cells[0];
                let from = self.starts[row + low[0]] as usize;
                let to = self.starts[row + high[0] + 1] as usize;
                // The last lanes may hold points of the next cells, which does no harm.
                for first in (from..to).step_by(LANES) {
                    self.compare(first, place, &mut least);
                }
            }
        }
        let least = least.into_iter().fold(f32::INFINITY, f32::min);
        (least < self.reach_m * self.reach_m).then_some(least)
    }

    /// Least squared distances from a place by lane, after those of the points from `first` on.
    #[inline]
    fn compare(&self, first: usize, place: [f32; 3], least: &mut [f32; LANES]) {
        let [x, y, z] = self
            .coordinates
            .each_ref()
            .map(|values| &values[first..first + LANES]);
        for lane in 0..LANES {
            let (dx, dy, dz) = (x[lane] - place[0], y[lane] - place[1], z[lane] - place[2]);
            let squared = dx * dx + dy * dy + dz * dz;
            least[lane] = if squared < least[lane] {
                squared
            } else {
                least[lane]
            };
        }
    }

    /// Cell of a place, which is moved by a part of a cell; the nearest one beyond the grid.
    fn cell(&self, place: [f32; 3], offset: f32) -> [usize; 3] {
        std::array::from_fn(|axis| {
            let cell = (place[axis] - self.first[axis]) / self.cell_m + offset;
            (cell.max(0.0) as usize).min(self.n_cells[axis] - 1)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = [f32; 3]> {
        prop::array::uniform3(-1.0_f32..1.0)
    }

    proptest! {
        #[test]
        fn nearest_distance_is_that_of_an_exhaustive_search(
            points in prop::collection::vec(point(), 0..60),
            place in prop::array::uniform3(-2.0_f32..2.0),
            reach in 0.01_f32..1.0,
        ) {
            let squared = |p: &[f32; 3]| {
                let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| p[axis] - place[axis]);
                x * x + y * y + z * z
            };
            let expected = points.iter().map(squared).reduce(f32::min);
            let expected = expected.filter(|least| *least < reach * reach);
            prop_assert_eq!(NearGrid::new(&points, reach).nearest_squared(place), expected);
        }
    }
}
