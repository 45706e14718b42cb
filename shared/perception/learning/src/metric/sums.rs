//! Sums over all bins of a term that is never negative, and the terms.
//!
//! Rounding never makes such a sum smaller, so a partial sum above a bound decides.

/// Independent sums, for vector instructions. They are added up in the same way
/// always, so a sum does not depend on whether it was bounded.
const LANES: usize = 16;

/// Values after which the sum is compared with the bound.
const BLOCK: usize = 8 * LANES;

/// What is divided by less is left out where the quotient has no bound of its own;
/// far below the share of one point, and no quotient overflows.
pub(super) const EMPTY_BELOW: f32 = 1e-12;

/// Taken for less where a logarithm follows: the share of one point of a million.
pub(super) const FLOOR: f32 = 1e-6;

/// The sum of the terms; `None` when it is larger than `bound`.
#[inline]
pub(super) fn bounded_sum(
    a: &[f32],
    b: &[f32],
    bound: f32,
    term: impl Fn(f32, f32) -> f32 + Copy,
) -> Option<f32> {
    let mut lanes = [0.0; LANES];
    for (a, b) in a.chunks(BLOCK).zip(b.chunks(BLOCK)) {
        add_block(&mut lanes, a, b, term);
        if total(&lanes) > bound {
            return None;
        }
    }
    Some(total(&lanes))
}

/// The sum of the terms.
#[inline]
pub(super) fn sum(a: &[f32], b: &[f32], term: impl Fn(f32, f32) -> f32) -> f32 {
    let mut lanes = [0.0; LANES];
    add_block(&mut lanes, a, b, term);
    total(&lanes)
}

#[inline]
fn add_block(lanes: &mut [f32; LANES], a: &[f32], b: &[f32], term: impl Fn(f32, f32) -> f32) {
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a.iter().zip(b) {
        for i in 0..LANES {
            lanes[i] += term(a[i], b[i]);
        }
    }
    for (lane, (&p, &q)) in lanes.iter_mut().zip(a_rest.iter().zip(b_rest)) {
        *lane += term(p, q);
    }
}

/// Sum of the lanes, halving their number at each step.
#[inline]
fn total(lanes: &[f32; LANES]) -> f32 {
    let mut lanes = *lanes;
    let mut n = LANES;
    while n > 1 {
        n /= 2;
        for i in 0..n {
            lanes[i] += lanes[i + n];
        }
    }
    lanes[0]
}

#[inline]
pub(super) fn absolute_difference(p: f32, q: f32) -> f32 {
    (p - q).abs()
}

#[inline]
pub(super) fn squared_difference(p: f32, q: f32) -> f32 {
    (p - q) * (p - q)
}

/// A bin empty in both gives 0 divided by a positive number.
#[inline]
pub(super) fn chi_squared(p: f32, q: f32) -> f32 {
    (p - q) * (p - q) / positive(p + q)
}

/// As for [`chi_squared`] where both are empty; 1 at most.
#[inline]
pub(super) fn relative_difference(p: f32, q: f32) -> f32 {
    (p - q).abs() / positive(p + q)
}

#[inline]
pub(super) fn squared_relative_difference(p: f32, q: f32) -> f32 {
    let relative = relative_difference(p, q);
    relative * relative
}

#[inline]
pub(super) fn pearson(p: f32, q: f32) -> f32 {
    if q < EMPTY_BELOW {
        0.0
    } else {
        (p - q) * (p - q) / q
    }
}

#[inline]
pub(super) fn squared_difference_of_roots(p: f32, q: f32) -> f32 {
    squared_difference(p.sqrt(), q.sqrt())
}

/// The term of Csiszár's I-divergence, which unlike `p ln(p / q)` is never negative
/// and has the same sum for histograms of equal sums.
#[inline]
pub(super) fn kullback_leibler(p: f32, q: f32) -> f32 {
    let (p, q) = (p.max(FLOOR), q.max(FLOOR));
    if p == q {
        return 0.0;
    }
    (p * (p / q).ln() - (p - q)).max(0.0)
}

/// The term of Jeffreys' divergence, the larger value first so that both orders
/// give the same bits.
#[inline]
pub(super) fn jeffreys(p: f32, q: f32) -> f32 {
    let (low, high) = (p.min(q).max(FLOOR), p.max(q).max(FLOOR));
    if low == high {
        return 0.0;
    }
    (high - low) * (high / low).ln()
}

#[inline]
fn positive(value: f32) -> f32 {
    if value > f32::MIN_POSITIVE {
        value
    } else {
        f32::MIN_POSITIVE
    }
}
