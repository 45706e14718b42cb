//! Numbers that look random and depend on a counter alone.
//!
//! Any pixel of any frame can be drawn on its own and again, in any order.

/// Mixes a 64-bit counter to 64 random bits (the finaliser of `SplitMix64`,
/// Steele, Lea and Flood 2014).
#[inline]
pub(super) fn mixed(counter: u64) -> u64 {
    let z = counter.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number in [0, 1) from 64 random bits.
pub(super) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// A number of mean 0 and deviation 1 from the lower 48 of 64 random bits: the
/// sum of four uniform ones. Never beyond 3.465, so that no point is ever far off.
#[inline]
pub(super) fn gaussian(bits: u64) -> f32 {
    // Four times 12 bits; the deviation of their sum is 4096 / sqrt(3).
    let sum = (bits & 0xfff) + (bits >> 12 & 0xfff) + (bits >> 24 & 0xfff) + (bits >> 36 & 0xfff);
    (sum as i32 - 8190) as f32 * (1.732_050_8 / 4096.0)
}
