//! Numbers that look like chance and are the same every time.

/// Numbers from -1 to 1 (Steele, Lea and Flood 2014).
pub(crate) fn noise(seed: u64) -> impl Iterator<Item = f32> {
    (1_u64..).map(move |i| {
        let mut z = (seed << 32)
            .wrapping_add(i)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    })
}
