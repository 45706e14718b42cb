//! Deterministic pseudo-random numbers for tests.

/// Uniform pseudo-random numbers from -1 to 1.
pub(crate) fn noise(seed: u64) -> impl Iterator<Item = f32> {
    (1_u64..).map(move |i| {
        2.0 * random::unit_f32(random::counter_based((seed << 32).wrapping_add(i))) - 1.0
    })
}
