//! Eigen decomposition of a symmetric 3 x 3 matrix, bit-exact with the reference
//! implementation of GOOD.
//!
//! The published descriptor depends on the signs of the eigenvectors, which are an
//! accident of its solver. This is the same sequence of single-precision operations: one
//! Householder step to tridiagonal form, then implicit QR steps with Wilkinson's shift
//! (Golub and Van Loan 1996, 8.3). Use it for that comparison only;
//! `point_cloud::Moments` is more accurate.

/// Symmetric matrix; only the lower triangle is read.
pub(crate) type Matrix = [[f32; 3]; 3];

/// Maximum number of QR steps per row.
const MAX_STEPS_PER_ROW: usize = 30;

/// Eigenvalues in ascending order with their unit eigenvectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Eigen {
    /// Eigenvalues, smallest first.
    pub values: [f32; 3],
    /// Eigenvectors in the order of the values.
    pub vectors: [[f32; 3]; 3],
}

/// Symmetric tridiagonal matrix during QR iteration.
struct Tridiagonal {
    diagonal: [f32; 3],
    /// Off-diagonal entries; entry `i` couples rows `i` and `i + 1`.
    off_diagonal: [f32; 2],
    /// Columns of the accumulated rotation matrix.
    columns: [[f32; 3]; 3],
}

/// Givens rotation.
#[derive(Clone, Copy)]
struct Givens {
    c: f32,
    s: f32,
}

/// Eigen decomposition; `None` when the matrix is not finite or the iteration does not
/// converge.
pub(crate) fn symmetric_eigen(matrix: &Matrix) -> Option<Eigen> {
    let lower = (0..3).flat_map(|i| matrix[i].iter().take(i + 1));
    if lower.clone().any(|v| !v.is_finite()) {
        return None;
    }
    let largest = lower.fold(0.0_f32, |largest, v| largest.max(v.abs()));
    let scale = if largest == 0.0 { 1.0 } else { largest };
    let mut t = tridiagonalise(&matrix.map(|row| row.map(|v| v / scale)));
    diagonalise(&mut t)?;
    sort_ascending(&mut t);
    Some(Eigen {
        values: t.diagonal.map(|v| v * scale),
        vectors: t.columns,
    })
}

fn tridiagonalise(a: &Matrix) -> Tridiagonal {
    let corner = a[2][0] * a[2][0];
    if corner <= f32::MIN_POSITIVE {
        return Tridiagonal {
            diagonal: [a[0][0], a[1][1], a[2][2]],
            off_diagonal: [a[1][0], a[2][1]],
            columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
    }
    let beta = (a[1][0] * a[1][0] + corner).sqrt();
    let inverse = 1.0 / beta;
    let (m1, m2) = (a[1][0] * inverse, a[2][0] * inverse);
    let q = 2.0 * m1 * a[2][1] + m2 * (a[2][2] - a[1][1]);
    Tridiagonal {
        diagonal: [a[0][0], a[1][1] + m2 * q, a[2][2] - m2 * q],
        off_diagonal: [beta, a[2][1] - m1 * q],
        columns: [[1.0, 0.0, 0.0], [0.0, m1, m2], [0.0, m2, -m1]],
    }
}

/// QR iteration with deflation until the matrix is diagonal.
fn diagonalise(t: &mut Tridiagonal) -> Option<()> {
    let (mut start, mut end) = (0, 2);
    for _ in 0..=3 * MAX_STEPS_PER_ROW {
        for i in start..end {
            if is_negligible(t, i) {
                t.off_diagonal[i] = 0.0;
            }
        }
        while end > 0 && t.off_diagonal[end - 1] == 0.0 {
            end -= 1;
        }
        if end == 0 {
            return Some(());
        }
        start = end - 1;
        while start > 0 && t.off_diagonal[start - 1] != 0.0 {
            start -= 1;
        }
        qr_step(t, start, end);
    }
    None
}

fn is_negligible(t: &Tridiagonal, i: usize) -> bool {
    let scaled = t.off_diagonal[i] / f32::EPSILON;
    t.off_diagonal[i].abs() < f32::MIN_POSITIVE
        || scaled * scaled <= t.diagonal[i].abs() + t.diagonal[i + 1].abs()
}

fn qr_step(t: &mut Tridiagonal, start: usize, end: usize) {
    let mut x = t.diagonal[start] - wilkinson_shift(t, end);
    let mut z = t.off_diagonal[start];
    for k in start..end {
        if z == 0.0 {
            break;
        }
        let rotation = givens(x, z);
        let Givens { c, s } = rotation;
        rotate_block(t, k, rotation);
        if k > start {
            t.off_diagonal[k - 1] = c * t.off_diagonal[k - 1] - s * z;
        }
        x = t.off_diagonal[k];
        if k + 1 < end {
            z = -s * t.off_diagonal[k + 1];
            t.off_diagonal[k + 1] *= c;
        }
        for row in 0..3 {
            let (q, next) = (t.columns[k][row], t.columns[k + 1][row]);
            t.columns[k][row] = c * q - s * next;
            t.columns[k + 1][row] = s * q + c * next;
        }
    }
}

/// Wilkinson's shift: the eigenvalue of the last 2 x 2 block nearer to its last entry.
fn wilkinson_shift(t: &Tridiagonal, end: usize) -> f32 {
    let half_difference = (t.diagonal[end - 1] - t.diagonal[end]) * 0.5;
    let e = t.off_diagonal[end - 1];
    if half_difference == 0.0 {
        return t.diagonal[end] - e.abs();
    }
    let root = hypotenuse(half_difference, e);
    let signed_root = if half_difference > 0.0 { root } else { -root };
    t.diagonal[end] - e * e / (half_difference + signed_root)
}

/// Hypotenuse `sqrt(a² + b²)` by the reference's formula; the standard library rounds
/// differently.
fn hypotenuse(a: f32, b: f32) -> f32 {
    let (a, b) = (a.abs(), b.abs());
    let larger = a.max(b);
    if larger == 0.0 {
        return 0.0;
    }
    let ratio = a.min(b) / larger;
    larger * (1.0 + ratio * ratio).sqrt()
}

/// Givens rotation that maps `(x, z)` to `(r, 0)`.
fn givens(x: f32, z: f32) -> Givens {
    if z == 0.0 {
        return Givens {
            c: if x < 0.0 { -1.0 } else { 1.0 },
            s: 0.0,
        };
    }
    if x == 0.0 {
        return Givens {
            c: 0.0,
            s: if z < 0.0 { 1.0 } else { -1.0 },
        };
    }
    if x.abs() > z.abs() {
        let t = z / x;
        let u = (1.0 + t * t).sqrt().copysign(x);
        let c = 1.0 / u;
        Givens { c, s: -t * c }
    } else {
        let t = x / z;
        let u = (1.0 + t * t).sqrt().copysign(z);
        let s = -1.0 / u;
        Givens { c: -t * s, s }
    }
}

/// Applies a Givens rotation to rows and columns `k` and `k + 1`.
fn rotate_block(t: &mut Tridiagonal, k: usize, Givens { c, s }: Givens) {
    let (d, e, next) = (t.diagonal[k], t.off_diagonal[k], t.diagonal[k + 1]);
    let sdk = s * d + c * e;
    let dk1 = s * e + c * next;
    t.diagonal[k] = c * (c * d - s * e) - s * (c * e - s * next);
    t.diagonal[k + 1] = s * sdk + c * dk1;
    t.off_diagonal[k] = c * sdk - s * dk1;
}

/// Selection sort by eigenvalue; stable for equal values.
fn sort_ascending(t: &mut Tridiagonal) {
    for i in 0..2 {
        let mut smallest = i;
        for j in i + 1..3 {
            if t.diagonal[j] < t.diagonal[smallest] {
                smallest = j;
            }
        }
        t.diagonal.swap(i, smallest);
        t.columns.swap(i, smallest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check(matrix: &Matrix) -> Result<(), TestCaseError> {
        let eigen = symmetric_eigen(matrix).unwrap();
        let size = matrix
            .iter()
            .flatten()
            .fold(1e-6_f32, |m, v| m.max(v.abs()));
        prop_assert!(eigen.values.is_sorted());
        for (value, vector) in eigen.values.iter().zip(&eigen.vectors) {
            let norm: f32 = vector.iter().map(|v| v * v).sum();
            prop_assert!((norm - 1.0).abs() < 1e-5);
            for row in 0..3 {
                let product: f32 = (0..3).map(|j| matrix[row][j] * vector[j]).sum();
                prop_assert!((product - value * vector[row]).abs() < 1e-5 * size);
            }
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn eigenvectors_satisfy_their_equation(e in prop::array::uniform6(-1.0_f32..1.0)) {
            check(&[[e[0], e[1], e[2]], [e[1], e[3], e[4]], [e[2], e[4], e[5]]])?;
        }

        #[test]
        fn small_matrices_are_solved(e in prop::array::uniform6(-1e-4_f32..1e-4)) {
            check(&[[e[0], e[1], 0.0], [e[1], e[3], e[4]], [0.0, e[4], e[5]]])?;
        }
    }

    #[test]
    fn special_matrices_are_solved() {
        check(&[[0.0; 3]; 3]).unwrap();
        check(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).unwrap();
        check(&[[3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]]).unwrap();
        check(&[[1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0]]).unwrap();
    }

    #[test]
    fn a_matrix_that_is_not_finite_has_no_solution() {
        let mut matrix = [[1.0; 3]; 3];
        for bad in [f32::NAN, f32::INFINITY] {
            matrix[2][1] = bad;
            assert_eq!(symmetric_eigen(&matrix), None);
        }
    }
}
