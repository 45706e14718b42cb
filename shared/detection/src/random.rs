//! A small seeded generator.

/// `SplitMix64` (Steele, Lea and Flood 2014): one word of state, good enough to
/// choose samples, and the same on every machine.
#[derive(Debug, Clone)]
pub(crate) struct Random {
    state: u64,
}

impl Random {
    pub(crate) fn from_seed(seed: u64) -> Self {
        Self { state: seed }
    }

    #[inline]
    fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `bound`; 0 when the bound is 0.
    #[inline]
    pub(crate) fn below(&mut self, bound: usize) -> usize {
        ((u128::from(self.next_u64()) * bound as u128) >> 64) as usize
    }

    /// A number from `-reach` to `reach`.
    #[inline]
    pub(crate) fn around_zero(&mut self, reach: usize) -> isize {
        self.below(2 * reach + 1) as isize - reach as isize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_in_range_and_repeat_with_the_seed() {
        let (mut a, mut b) = (Random::from_seed(7), Random::from_seed(7));
        let mut seen = [0; 5];
        for _ in 0..5000 {
            let value = a.below(5);
            assert_eq!(value, b.below(5));
            seen[value] += 1;
            let around = a.around_zero(3);
            assert_eq!(around, b.around_zero(3));
            assert!(around.abs() <= 3);
        }
        assert!(seen.iter().all(|&n| n > 900), "{seen:?}");
        assert_eq!(a.below(0), 0);
    }
}
