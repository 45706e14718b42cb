//! Eigenvalues of a symmetric matrix with the eigenvector of the least one, in closed form: the
//! plane of points from their covariance.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// Eigenvalues of a symmetric matrix in ascending order, with a unit eigenvector of the least one
/// (Smith 1961). Where that is not single, the eigenvector is any unit vector.
pub fn least_eigenvector(matrix: &Matrix3<f64>) -> ([f64; 3], Vector3<f64>) {
    let eigenvalues = eigenvalues(matrix);
    // The rows of the difference are at right angles to the eigenvector.
    let difference = matrix - Matrix3::identity() * eigenvalues[0];
    let rows = [0, 1, 2].map(|i| difference.row(i).transpose());
    let products = [[0, 1], [1, 2], [2, 0]].map(|[a, b]| rows[a].cross(&rows[b]));
    let longest = products
        .into_iter()
        .max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    let vector = longest.and_then(|product| product.try_normalize(f64::MIN_POSITIVE));
    (eigenvalues, vector.unwrap_or_else(Vector3::z))
}

fn eigenvalues(matrix: &Matrix3<f64>) -> [f64; 3] {
    let mean = matrix.trace() / 3.0;
    let centred = matrix - Matrix3::identity() * mean;
    let spread = (centred.norm_squared() / 6.0).sqrt();
    if spread <= f64::MIN_POSITIVE {
        return [mean; 3];
    }
    let half_determinant = 0.5 * (centred / spread).determinant();
    let angle = half_determinant.clamp(-1.0, 1.0).acos() / 3.0;
    let least = mean + 2.0 * spread * (angle + TAU / 3.0).cos();
    let largest = mean + 2.0 * spread * angle.cos();
    [least, 3.0 * mean - least - largest, largest]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, SymmetricEigen};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn least_eigenvector_matches_the_iterative_solver(
            values in prop::array::uniform3(1e-6..1e-2_f64),
            angles in prop::array::uniform3(-3.0..3.0_f64),
        ) {
            let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
            let diagonal = Matrix3::from_diagonal(&Vector3::from(values));
            let matrix = turn.matrix() * diagonal * turn.matrix().transpose();
            let eigen = SymmetricEigen::new(matrix);
            let (values, vector) = least_eigenvector(&matrix);
            let least = values[0];
            let mut expected: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
            expected.sort_by(f64::total_cmp);
            for (value, expected) in values.iter().zip(expected) {
                prop_assert!((value - expected).abs() < 1e-9);
            }
            prop_assert!((matrix * vector - vector * least).norm() < 1e-6);
            prop_assert!((vector.norm() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn equal_eigenvalues_give_a_unit_vector() {
        for matrix in [Matrix3::zeros(), Matrix3::identity()] {
            let ([least, ..], vector) = least_eigenvector(&matrix);
            assert!((least - matrix[(0, 0)]).abs() < 1e-12 && vector.norm() == 1.0);
        }
    }
}
