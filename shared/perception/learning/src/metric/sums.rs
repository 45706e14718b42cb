//! Dissimilarities that are sums of non-negative terms, with early termination.
//!
//! Rounding never decreases such a sum, so a partial sum above the bound is conclusive.

/// Number of independent partial sums, for vector instructions. They are always added in
/// the same order, so the sum does not depend on the bound.
const LANES: usize = 16;

/// Number of values between comparisons with the bound.
const BLOCK_LEN: usize = 8 * LANES;

/// Denominators below this value are skipped where the quotient is unbounded; far below
/// the share of one point, and large enough that no quotient overflows.
pub(super) const DENOMINATOR_MIN: f32 = 1e-12;

/// Lower limit of arguments of a logarithm: the share of one point in a million.
pub(super) const LOGARITHM_ARGUMENT_MIN: f32 = 1e-6;

/// Sum of the distance terms; `None` when it exceeds `bound`.
#[inline]
pub(super) fn bounded_sum(
    a: &[f32],
    b: &[f32],
    bound: f32,
    term: impl Fn(f32, f32) -> f32 + Copy,
) -> Option<f32> {
    let mut lanes = [0.0; LANES];
    for (a, b) in a.chunks(BLOCK_LEN).zip(b.chunks(BLOCK_LEN)) {
        add_block(&mut lanes, a, b, term);
        if total(&lanes) > bound {
            return None;
        }
    }
    Some(total(&lanes))
}

/// Sum of a term over the elements of two descriptors.
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

/// Sum of the lanes by pairwise halving.
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

/// Term of the chi-squared distance; a bin empty in both gives 0 divided by a positive
/// number.
#[inline]
pub(super) fn chi_squared(p: f32, q: f32) -> f32 {
    (p - q) * (p - q) / positive(p + q)
}

/// Term of the Canberra distance, at most 1; 0 for a bin empty in both.
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
    if q < DENOMINATOR_MIN {
        0.0
    } else {
        (p - q) * (p - q) / q
    }
}

#[inline]
pub(super) fn squared_difference_of_roots(p: f32, q: f32) -> f32 {
    squared_difference(p.sqrt(), q.sqrt())
}

/// Term of Csiszár's I-divergence. Unlike `p ln(p / q)` it is never negative, and it has
/// the same sum for histograms of equal sums.
#[inline]
pub(super) fn kullback_leibler(p: f32, q: f32) -> f32 {
    let (p, q) = (p.max(LOGARITHM_ARGUMENT_MIN), q.max(LOGARITHM_ARGUMENT_MIN));
    if p == q {
        return 0.0;
    }
    (p * (p / q).ln() - (p - q)).max(0.0)
}

/// Term of Jeffreys' divergence, the larger value first, so that both orders give the
/// same bits.
#[inline]
pub(super) fn jeffreys(p: f32, q: f32) -> f32 {
    let (low, high) = (
        p.min(q).max(LOGARITHM_ARGUMENT_MIN),
        p.max(q).max(LOGARITHM_ARGUMENT_MIN),
    );
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
