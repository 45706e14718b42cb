//! Distances that are quotients of sums over all bins: none is known before the
//! last bin.

use super::sums::{absolute_difference, squared_difference, sum};

/// Least argument of Bhattacharyya's logarithm: below what one point in common
/// weighs, and finite.
pub(super) const LEAST_COEFFICIENT: f64 = 1e-9;

pub(super) fn motyka(a: &[f32], b: &[f32]) -> f32 {
    // Plain comparisons here and below, which are one instruction each.
    let larger = sum(a, b, |p, q| if p > q { p } else { q });
    quotient(larger, both(a, b), 0.5)
}

pub(super) fn sorensen(a: &[f32], b: &[f32]) -> f32 {
    quotient(sum(a, b, absolute_difference), both(a, b), 0.0)
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
    // In double precision a square has its exact root: equal ones are at 0.
    let norms = (squares_a * squares_b).sqrt();
    let similarity = if norms > 0.0 { product / norms } else { 0.0 };
    // Rounding may exceed the bound of Cauchy and Schwarz.
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
    // In double precision no product vanishes, and a square has its exact root.
    let common = sum(a, b, |p, q| (f64::from(p) * f64::from(q)).sqrt() as f32);
    let masses = (mass_a * mass_b).sqrt();
    let coefficient = if masses > 0.0 {
        f64::from(common) / masses
    } else {
        0.0
    };
    // From 1 on by rounding only.
    -coefficient.clamp(LEAST_COEFFICIENT, 1.0).ln() as f32
}

fn both(a: &[f32], b: &[f32]) -> f32 {
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
