//! The columns, or the rows, of the image that points were seen in.

/// Values nearer than this share of the pitch are of one column.
const COLUMN_TOLERANCE: f64 = 0.12;

/// The pitch may differ from the one guessed by these factors.
const PITCH_RATIO: [f64; 2] = [0.5, 1.6];

/// Greatest mean distance of the columns from the lattice, in pitches.
const RESIDUAL_MAX: f64 = 0.08;

/// Fewest columns that make a lattice.
const N_COLUMNS_MIN: usize = 16;

/// More columns than any lattice has before its first.
const COLUMN_OFFSET: i64 = 1 << 32;

/// Evenly spaced tangents: column `i` looks along `first + i * pitch`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PixelLattice {
    first: f64,
    pitch: f64,
    columns_per_tangent: f64,
}

impl PixelLattice {
    /// A lattice of positive pitch.
    pub(super) fn new(first: f64, pitch: f64) -> Self {
        Self {
            first,
            pitch,
            columns_per_tangent: 1.0 / pitch,
        }
    }

    /// The tangent of a column.
    pub(super) fn tangent_of(&self, column: i64) -> f64 {
        self.first + self.pitch * column as f64
    }

    /// Step between columns, tangent.
    pub(super) fn pitch(&self) -> f64 {
        self.pitch
    }

    /// The column nearest to a tangent; may be negative.
    #[inline]
    pub(super) fn column_of(&self, tangent: f32) -> i64 {
        // Truncated where all values are positive, which is faster than to round.
        let column = (f64::from(tangent) - self.first) * self.columns_per_tangent;
        (column + (COLUMN_OFFSET as f64 + 0.5)) as i64 - COLUMN_OFFSET
    }

    /// The lattice with every `n` columns, a whole number, made one.
    pub(super) fn downsampled(&self, n: f64) -> Self {
        Self::new(self.first + 0.5 * (n - 1.0) * self.pitch, self.pitch * n)
    }

    /// Fits a lattice to the tangents of points, of which a sample is enough;
    /// `None` when they do not lie on one. `tangents` are sorted, `columns` is
    /// a buffer.
    ///
    /// The distinct values are numbered from one to the next, which needs no
    /// exact pitch, and a line is fitted through values over numbers.
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

/// Least squares of the values over their numbers, which count on by the
/// rounded distance to the value before.
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
