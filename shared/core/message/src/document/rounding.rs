//! Rounding of single-precision values for printing.

/// `f32` value as an `f64` rounded to 1e-7, so that it prints with few digits.
pub fn rounded(value: f32) -> f64 {
    (f64::from(value) * 1e7).round() / 1e7
}
