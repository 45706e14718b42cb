//! Dissimilarities that are quotients of sums over all bins, without early termination.

use super::sums::{absolute_difference, squared_difference, sum};

/// Smallest argument of the Bhattacharyya logarithm: below the weight of one common
/// point, and finite.
pub(super) const BHATTACHARYYA_COEFFICIENT_MIN: f64 = 1e-9;

pub(super) fn motyka(a: &[f32], b: &[f32]) -> f32 {
    // Plain comparisons here and below compile to one instruction each.
    let larger = sum(a, b, |p, q| if p > q { p } else { q });
    quotient(larger, total_mass(a, b), 0.5)
}

pub(super) fn sorensen(a: &[f32], b: &[f32]) -> f32 {
    quotient(sum(a, b, absolute_difference), total_mass(a, b), 0.0)
}

pub(super) fn dice(a: &[f32], b: &[f32]) -> f32 {
    let squares = sum(a, b, |p, q| p * p + q * q);
    quotient(sum(a, b, squared_difference), squares, 0.0)
}

pub(super) fn cosine(a: &[f32], b: &[f32]) -> f32 {
    let product = f64::from(sum(a, b, |p, q| p * q));
    let squares_a = f64::from(sum(a, a, |p, _| p * p));
    let squares_b = f64::from(sum(b, b, |q, _| q * q));
    if squares_a == squares_b && squares_a == 0.0 {
        return 0.0;
    }
    // In double precision the root of a square is exact: equal descriptors have distance
    // 0.
    let norms = (squares_a * squares_b).sqrt();
    let similarity = if norms > 0.0 { product / norms } else { 0.0 };
    // Rounding may exceed the Cauchy-Schwarz bound.
    (1.0 - similarity).max(0.0) as f32
}

pub(super) fn intersection(a: &[f32], b: &[f32]) -> f32 {
    let common = sum(a, b, |p, q| if p < q { p } else { q });
    1.0 - quotient(common, mass(a).max(mass(b)), 1.0)
}

pub(super) fn bhattacharyya(a: &[f32], b: &[f32]) -> f32 {
    let (mass_a, mass_b) = (f64::from(mass(a)), f64::from(mass(b)));
    if mass_a == mass_b && mass_a == 0.0 {
        return 0.0;
    }
    // In double precision no product underflows, and the root of a square is exact.
    let common = sum(a, b, |p, q| (f64::from(p) * f64::from(q)).sqrt() as f32);
    let masses = (mass_a * mass_b).sqrt();
    let coefficient = if masses > 0.0 {
        f64::from(common) / masses
    } else {
        0.0
    };
    // Only rounding can exceed 1.
    -coefficient.clamp(BHATTACHARYYA_COEFFICIENT_MIN, 1.0).ln() as f32
}

fn total_mass(a: &[f32], b: &[f32]) -> f32 {
    sum(a, b, |p, q| p + q)
}

fn mass(a: &[f32]) -> f32 {
    sum(a, a, |p, _| p)
}

fn quotient(numerator: f32, denominator: f32, if_empty: f32) -> f32 {
    if denominator > 0.0 {
        numerator / denominator
    } else {
        if_empty
    }
}
