//! Pixel lattice: recovers the columns, or rows, of the image from which points were seen.

/// Greatest gap between values of one column, share of the pitch. Chosen.
const COLUMN_TOLERANCE: f64 = 0.12;

/// Accepted ratio of the fitted to the guessed pitch. Chosen.
const PITCH_RATIO: [f64; 2] = [0.5, 1.6];

/// Greatest mean distance of the columns from the lattice, in pitches. Chosen.
const RESIDUAL_MAX: f64 = 0.08;

/// Least number of columns of a lattice. Chosen.
const N_COLUMNS_MIN: usize = 16;

/// Offset that makes all column numbers positive.
const COLUMN_OFFSET: i64 = 1 << 32;

/// Pixel lattice: evenly spaced tangents; column `i` views along `first + i * pitch`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PixelLattice {
    first: f64,
    pitch: f64,
    columns_per_tangent: f64,
}

impl PixelLattice {
    /// Lattice of pixel tangents with a positive pitch.
    pub(super) fn new(first: f64, pitch: f64) -> Self {
        Self {
            first,
            pitch,
            columns_per_tangent: 1.0 / pitch,
        }
    }

    /// Tangent of the viewing angle of a column.
    pub(super) fn tangent_of(&self, column: i64) -> f64 {
        self.first + self.pitch * column as f64
    }

    /// Pitch: the step between columns, as tangent.
    pub(super) fn pitch(&self) -> f64 {
        self.pitch
    }

    /// Column nearest to a tangent; may be negative.
    #[inline]
    pub(super) fn column_of(&self, tangent: f32) -> i64 {
        // Truncation of a positive value is faster than rounding.
        let column = (f64::from(tangent) - self.first) * self.columns_per_tangent;
        (column + (COLUMN_OFFSET as f64 + 0.5)) as i64 - COLUMN_OFFSET
    }

    /// Lattice with every `n` columns merged into one; `n` is a whole number.
    pub(super) fn downsampled(&self, n: f64) -> Self {
        Self::new(self.first + 0.5 * (n - 1.0) * self.pitch, self.pitch * n)
    }

    /// Fit a lattice to the tangents of sampled points; `None` when they do not fit one.
    /// Sorts `tangents`; `columns` and `gaps` are buffers.
    ///
    /// Distinct values are numbered by rounded steps, which needs no exact pitch, and a
    /// line is fitted through values over numbers.
    pub(super) fn fit(
        tangents: &mut [f32],
        pitch_guess: f64,
        columns: &mut Vec<f64>,
        gaps: &mut Vec<f64>,
    ) -> Option<Self> {
        tangents.sort_unstable_by(f32::total_cmp);
        columns.clear();
        let same = |a: &f32, b: &f32| f64::from(b - a) < COLUMN_TOLERANCE * pitch_guess;
        for group in tangents.chunk_by(same) {
            let (first, last) = (f64::from(group[0]), f64::from(group[group.len() - 1]));
            if last - first > 2.0 * COLUMN_TOLERANCE * pitch_guess {
                return None;
            }
            columns.push(0.5 * (first + last));
        }
        if columns.len() < N_COLUMNS_MIN {
            return None;
        }
        gaps.clear();
        gaps.extend(columns.windows(2).map(|pair| pair[1] - pair[0]));
        gaps.sort_unstable_by(f64::total_cmp);
        let pitch = gaps[gaps.len() / 2];
        let plausible = PITCH_RATIO[0] * pitch_guess..=PITCH_RATIO[1] * pitch_guess;
        if !plausible.contains(&pitch) {
            return None;
        }
        let lattice = line_through(columns, pitch);
        let residual: f64 = columns.iter().map(|value| lattice.residual(*value)).sum();
        (residual <= RESIDUAL_MAX * columns.len() as f64).then_some(lattice)
    }

    /// Distance of a value from its column, in pitches.
    fn residual(&self, value: f64) -> f64 {
        let column = (value - self.first) / self.pitch;
        (column - column.round()).abs()
    }
}

/// Least-squares line through the values over their column numbers, which advance by the
/// rounded distance to the previous value.
fn line_through(values: &[f64], pitch: f64) -> PixelLattice {
    let (mut number, mut before) = (0.0, values[0]);
    let (mut n, mut sum_k, mut sum_v, mut sum_kk, mut sum_kv) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &value in values {
        number += ((value - before) / pitch).round();
        before = value;
        let v = value - values[0];
        n += 1.0;
        sum_k += number;
        sum_v += v;
        sum_kk += number * number;
        sum_kv += number * v;
    }
    let spread = n * sum_kk - sum_k * sum_k;
    let fitted = (n * sum_kv - sum_k * sum_v) / spread.max(1.0);
    let first = values[0] + (sum_v - fitted * sum_k) / n;
    PixelLattice::new(first, fitted.max(0.25 * pitch))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fit(values: &mut [f32], guess: f64) -> Option<PixelLattice> {
        PixelLattice::fit(values, guess, &mut Vec::new(), &mut Vec::new())
    }

    proptest! {
        #[test]
        fn columns_with_gaps_and_rounding_are_numbered_right(
            pitch in 5e-4..4e-3_f64,
            first in -0.8..-0.2_f64,
            guess in 0.85..1.3_f64,
            kept in prop::collection::vec(prop::bool::weighted(0.8), 200..700),
        ) {
            let columns: Vec<usize> = (0..kept.len()).filter(|&i| kept[i]).collect();
            let mut values: Vec<f32> = columns
                .iter()
                .map(|&i| (first + pitch * i as f64) as f32)
                .rev()
                .collect();
            let lattice = fit(&mut values, guess * pitch).expect("a lattice");
            let start = lattice.column_of((first + pitch * columns[0] as f64) as f32);
            for &column in &columns {
                let value = (first + pitch * column as f64) as f32;
                prop_assert_eq!(lattice.column_of(value) - start, (column - columns[0]) as i64);
            }
        }

        #[test]
        fn joined_columns_are_whole_columns(pitch in 5e-4..4e-3_f64, n in 1..6_u32) {
            let lattice = PixelLattice::new(-0.3, pitch);
            let downsampled = lattice.downsampled(f64::from(n));
            for column in 0..300_u32 {
                let tangent = (-0.3 + pitch * f64::from(column)) as f32;
                prop_assert_eq!(downsampled.column_of(tangent), i64::from(column / n));
            }
        }

        #[test]
        fn scattered_values_are_no_lattice(values in prop::collection::vec(-0.5..0.5_f32, 4000)) {
            prop_assert_eq!(fit(&mut values.clone(), 1.0 / 600.0), None);
        }
    }
}
