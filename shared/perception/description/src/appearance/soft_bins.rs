//! Histogram bins with linear interpolation.

/// Interpolated bins over 0 to 1. A value between two bin centres counts for both by its
/// distance, so that the histogram changes continuously.
#[derive(Debug, Clone, Copy)]
pub(super) struct SoftBins {
    n: f32,
    /// Upper limit of positions, just below the centre of the last bin, so that a next
    /// bin exists.
    last: f32,
}

impl SoftBins {
    pub(super) const fn new(n: usize) -> Self {
        Self {
            n: n as f32,
            last: n as f32 - 1.000_01,
        }
    }

    /// Lower of the two bins and the weight of the upper one. Values outside the range
    /// are clamped.
    #[inline]
    pub(super) fn locate(self, value: f32) -> (u32, f32) {
        let place = (value * self.n - 0.5).max(0.0).min(self.last);
        let bin = place as u32;
        (bin, place - bin as f32)
    }
}

/// Adds one count to a row-major histogram with bilinear interpolation.
#[inline]
pub(super) fn add(cells: &mut [f32], n_columns: usize, row: (u32, f32), column: (u32, f32)) {
    add_weighted(cells, n_columns, (row, column), 1.0);
}

/// Adds a weighted count to a row-major histogram with bilinear interpolation.
#[inline]
pub(super) fn add_weighted(
    cells: &mut [f32],
    n_columns: usize,
    (row, column): ((u32, f32), (u32, f32)),
    weight: f32,
) {
    let first = row.0 as usize * n_columns + column.0 as usize;
    let Some(around) = cells.get_mut(first..first + n_columns + 2) else {
        return;
    };
    let (upper, lower) = (weight * row.1, weight * (1.0 - row.1));
    around[0] += lower * (1.0 - column.1);
    around[1] += lower * column.1;
    around[n_columns] += upper * (1.0 - column.1);
    around[n_columns + 1] += upper * column.1;
}

/// Adds a weighted count to a histogram of one dimension with linear interpolation.
#[inline]
pub(super) fn add_linear(cells: &mut [f32], (bin, share): (u32, f32), weight: f32) {
    cells[bin as usize] += weight * (1.0 - share);
    cells[bin as usize + 1] += weight * share;
}

/// Replaces counts by their fourth roots, normalised to unit length. Roots damp frequent
/// values (Arandjelović and Zisserman 2012 use square roots); the sampling density of a
/// surface depends on its orientation to the camera.
pub(super) fn normalise_fourth_roots(cells: &mut [f32]) {
    let mut squares = 0.0;
    for cell in &mut *cells {
        let root = cell.sqrt();
        squares += root;
        *cell = root.sqrt();
    }
    if squares > 0.0 {
        let scale = squares.sqrt().recip();
        for cell in cells {
            *cell *= scale;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_interpolated_between_two_bins() {
        let bins = SoftBins::new(4);
        assert_eq!(bins.locate(0.125), (0, 0.0));
        assert_eq!(bins.locate(0.25), (0, 0.5));
        assert_eq!(bins.locate(0.0), (0, 0.0));
        let (bin, share) = bins.locate(1.0);
        assert!(bin == 2 && share > 0.999);
        assert_eq!(bins.locate(f32::NEG_INFINITY), (0, 0.0));
    }

    #[test]
    fn an_added_count_sums_to_one() {
        let mut cells = [0.0; 12];
        add(&mut cells, 4, (1, 0.25), (2, 0.5));
        assert!((cells.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert_eq!(cells[6], 0.375);
        assert_eq!(cells[11], 0.125);
    }

    #[test]
    fn fourth_roots_have_unit_length_and_zeros_stay_zero() {
        let mut cells = [16.0, 0.0, 1.0];
        normalise_fourth_roots(&mut cells);
        assert!((cells.iter().map(|c| c * c).sum::<f32>() - 1.0).abs() < 1e-6);
        assert!((cells[0] / cells[2] - 2.0).abs() < 1e-6);
        let mut nothing = [0.0; 3];
        normalise_fourth_roots(&mut nothing);
        assert_eq!(nothing, [0.0; 3]);
    }
}
