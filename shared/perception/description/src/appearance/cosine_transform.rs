//! Truncated two-dimensional discrete cosine transform (DCT).

use std::f64::consts::PI;

/// Bins per side of a projection.
pub(super) const SIDE: usize = 16;

/// Number of frequencies per side; the sum of a coefficient's two frequencies is
/// smaller. Chosen.
const N_FREQUENCIES: usize = 12;

/// Number of coefficients of one projection.
pub(super) const N_COEFFICIENTS: usize = N_FREQUENCIES * (N_FREQUENCIES + 1) / 2;

/// Orthonormal cosine transform (type II; Ahmed, Natarajan and Rao 1974) of `SIDE` x
/// `SIDE` cells, truncated to low frequencies. Orthonormality preserves distances of the
/// smoothed cells. The basis functions are even or odd, so reversing an axis only
/// changes signs.
#[derive(Debug, Clone)]
pub(super) struct CosineTransform {
    /// Basis functions: one row per frequency, one column per bin.
    basis: [[f32; SIDE]; N_FREQUENCIES],
}

impl CosineTransform {
    pub(super) fn new() -> Self {
        let value = |frequency: usize, bin: usize| {
            let scale = if frequency == 0 { 1.0 } else { 2.0_f64.sqrt() };
            let angle = PI * frequency as f64 * (bin as f64 + 0.5) / SIDE as f64;
            (scale * angle.cos() / (SIDE as f64).sqrt()) as f32
        };
        Self {
            basis: std::array::from_fn(|k| std::array::from_fn(|i| value(k, i))),
        }
    }

    /// Appends the coefficients of row-major cells, in the order of [`frequencies`].
    pub(super) fn append(&self, cells: &[f32; SIDE * SIDE], out: &mut Vec<f32>) {
        for (k, of_row) in self.basis.iter().enumerate() {
            let mut column_sums = [0.0; SIDE];
            for (row, &weight) in cells.as_chunks::<SIDE>().0.iter().zip(of_row) {
                for (sum, &cell) in column_sums.iter_mut().zip(row) {
                    *sum += weight * cell;
                }
            }
            let of_columns = &self.basis[..N_FREQUENCIES - k];
            out.extend(of_columns.iter().map(|basis| dot(basis, &column_sums)));
        }
    }
}

/// Frequency pairs (of rows, of columns) in the order of the coefficients.
pub(super) fn frequencies() -> impl Iterator<Item = (usize, usize)> {
    (0..N_FREQUENCIES).flat_map(|k| (0..N_FREQUENCIES - k).map(move |l| (k, l)))
}

fn dot(a: &[f32; SIDE], b: &[f32; SIDE]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transformed(cells: &[f32; SIDE * SIDE]) -> Vec<f32> {
        let mut out = Vec::new();
        CosineTransform::new().append(cells, &mut out);
        out
    }

    #[test]
    fn a_basis_function_has_one_coefficient() {
        let transform = CosineTransform::new();
        for (wanted, (k, l)) in frequencies().enumerate() {
            let cells = std::array::from_fn(|i| {
                transform.basis[k][i / SIDE] * transform.basis[l][i % SIDE]
            });
            for (i, coefficient) in transformed(&cells).into_iter().enumerate() {
                let expected = if i == wanted { 1.0 } else { 0.0 };
                assert!((coefficient - expected).abs() < 1e-5, "{k} {l} {i}");
            }
        }
        assert_eq!(frequencies().count(), N_COEFFICIENTS);
    }

    #[test]
    fn the_truncated_transform_never_increases_the_norm() {
        let cells = std::array::from_fn(|i| ((i * 7919) % 31) as f32);
        let length = |values: &[f32]| values.iter().map(|v| v * v).sum::<f32>();
        assert!(length(&transformed(&cells)) <= length(&cells) * 1.000_01);
    }
}
