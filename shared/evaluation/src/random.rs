//! Chance that is the same on every machine.

/// A stream of numbers that depends on its seed and its purpose alone
/// (`SplitMix64`: Steele, Lea and Flood 2014).
#[derive(Debug, Clone)]
pub(crate) struct Random {
    state: u64,
}

impl Random {
    /// The stream of a purpose: a new use of chance does not shift the others.
    pub(crate) fn new(seed: u64, purpose: u64) -> Self {
        // The seed is mixed first, or one seed's stream were another's of another purpose.
        let seed = Self { state: seed }.bits();
        let state = seed ^ purpose;
        Self {
            state: Self { state }.bits(),
        }
    }

    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// A whole number below `n`; 0 when there is none.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        // The high half of the product: uneven by n / 2^64 at most.
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }

    /// Evenly distributed, 0 included, 1 not.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Puts values in random order (Fisher and Yates 1938).
    pub(crate) fn shuffle<T>(&mut self, values: &mut [T]) {
        for last in (1..values.len()).rev() {
            values.swap(last, self.below(last + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shuffle_is_a_permutation_and_every_place_is_as_likely() {
        let mut counts = [[0_u32; 5]; 5];
        let mut random = Random::new(7, 0);
        for _ in 0..10_000 {
            let mut values = [0, 1, 2, 3, 4];
            random.shuffle(&mut values);
            for (place, value) in values.into_iter().enumerate() {
                counts[place][value] += 1;
            }
            values.sort_unstable();
            assert_eq!(values, [0, 1, 2, 3, 4]);
        }
        // 2000 expected; the standard deviation is 40.
        let in_range = |count: &u32| (1800..=2200).contains(count);
        assert!(counts.as_flattened().iter().all(in_range), "{counts:?}");
    }

    #[test]
    fn streams_depend_on_seed_and_purpose() {
        let first = |seed, purpose| Random::new(seed, purpose).bits();
        let all = [first(1, 0), first(0, 1), first(1, 1), first(2, 0)];
        assert!((0..4).all(|i| (0..i).all(|j| all[i] != all[j])), "{all:?}");
        assert_eq!(first(1, 0), first(1, 0));
        let mut random = Random::new(3, 3);
        let mean = (0..1000).map(|_| random.unit()).sum::<f64>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.05, "{mean}");
        assert_eq!(random.below(0), 0);
    }
}
