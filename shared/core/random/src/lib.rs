//! Seeded pseudorandom numbers, the same on every machine.
//!
//! For simulations, samples and tests that must repeat, not for secrets. All
//! numbers come from `SplitMix64` (Steele, Lea and Flood 2014, "Fast splittable
//! pseudorandom number generators"): one word of state, period 2^64. Recorded
//! results depend on the numbers, so they never change.
//!
//! # Example
//!
//! ```
//! use random::Random;
//!
//! let mut random = Random::from_seed(1_234_567);
//! assert_eq!(random.next_u64(), 6_457_827_717_110_365_317);
//! let weight = random.between(0.5, 1.5);
//! assert!((0.5..1.5).contains(&weight));
//! ```

/// State increment ("golden gamma", Steele et al. 2014): 2^64 divided by the golden ratio, odd.
const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// Pseudorandom number generator (`SplitMix64`), determined by its seed alone.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Random {
    state: u64,
}

impl Random {
    /// Creates a generator from a seed. Seeds that differ by a multiple of the state increment
    /// share numbers; combine the parts of a composite seed with [`mix64`].
    #[inline]
    pub const fn from_seed(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Creates an independent substream for one purpose of an experiment, so that new uses of
    /// randomness do not shift the others.
    pub const fn substream(seed: u64, purpose: u64) -> Self {
        // Mixed twice: otherwise one seed's stream equals another seed's for another purpose.
        Self::from_seed(mix64(mix64(seed) ^ purpose))
    }

    /// Next 64 random bits.
    #[inline]
    pub const fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN_GAMMA);
        finalize(self.state)
    }

    /// Uniform random number in [0, 1).
    #[inline]
    pub fn unit(&mut self) -> f64 {
        unit(self.next_u64())
    }

    /// Uniform number in [0, 1), single precision.
    #[inline]
    pub fn unit_f32(&mut self) -> f32 {
        unit_f32(self.next_u64())
    }

    /// Approximately standard normal number: the sum of twelve uniform ones (Irwin and Hall).
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }

    /// Approximately standard normal number, single precision.
    pub fn normal_f32(&mut self) -> f32 {
        (0..12).map(|_| self.unit_f32()).sum::<f32>() - 6.0
    }

    /// Uniform random number in [`low`, `high`).
    #[inline]
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform integer below `bound`; 0 when the bound is 0.
    #[inline]
    pub fn below(&mut self, bound: usize) -> usize {
        // High half of the product: bias of at most bound / 2^64.
        ((u128::from(self.next_u64()) * bound as u128) >> 64) as usize
    }

    /// Uniform choice of an element; `None` for an empty slice.
    pub fn choice<'a, T>(&mut self, choices: &'a [T]) -> Option<&'a T> {
        choices.get(self.below(choices.len()))
    }

    /// Random permutation in place (Fisher and Yates 1938).
    pub fn shuffle<T>(&mut self, values: &mut [T]) {
        for last in (1..values.len()).rev() {
            values.swap(last, self.below(last + 1));
        }
    }
}

/// 64-bit mixing function: first number of the generator with seed `bits`.
#[inline]
pub const fn mix64(bits: u64) -> u64 {
    Random::from_seed(bits).next_u64()
}

/// Counter-based random number: the `index`-th number, from 1, of the generator with seed 0.
/// For noise indexed by position and drawn in any order.
#[inline]
pub const fn counter_based(index: u64) -> u64 {
    finalize(index.wrapping_mul(GOLDEN_GAMMA))
}

/// Converts 64 random bits to a number in [0, 1).
#[inline]
pub const fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Converts 64 random bits to a number in [0, 1), single precision.
#[inline]
pub const fn unit_f32(bits: u64) -> f32 {
    (bits >> 40) as f32 / (1_u64 << 24) as f32
}

/// Finalizer of `SplitMix64`: every bit of the result depends on every bit of the state.
#[inline]
const fn finalize(state: u64) -> u64 {
    let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference values: first numbers of seed 1234567, as published by the generator's authors.
    #[test]
    fn the_numbers_are_those_of_split_mix_64() {
        let mut random = Random::from_seed(1_234_567);
        let first: Vec<u64> = (0..5).map(|_| random.next_u64()).collect();
        assert_eq!(
            first,
            [
                6_457_827_717_110_365_317,
                3_203_168_211_198_807_973,
                9_817_491_932_198_370_423,
                4_593_380_528_125_082_431,
                16_408_922_859_458_223_821
            ]
        );
    }

    #[test]
    fn numbers_are_available_by_index() {
        let mut random = Random::from_seed(0);
        for index in 1..100 {
            assert_eq!(counter_based(index), random.next_u64());
        }
        assert_eq!(mix64(77), Random::from_seed(77).next_u64());
    }

    #[test]
    fn numbers_stay_in_range_use_all_of_it_and_repeat_with_the_seed() {
        let (mut a, mut b) = (Random::from_seed(7), Random::from_seed(7));
        let mut seen = [0; 5];
        for _ in 0..5000 {
            let value = a.below(5);
            assert_eq!(value, b.below(5));
            seen[value] += 1;
        }
        assert!(seen.iter().all(|&n| n > 900), "{seen:?}");
        assert_eq!(a.below(0), 0);
        let values: Vec<f64> = (0..1000).map(|_| a.between(-1.0, 3.0)).collect();
        assert!(values.iter().all(|x| (-1.0..3.0).contains(x)));
        let mean = values.iter().sum::<f64>() / 1000.0;
        assert!((mean - 1.0).abs() < 0.2, "{mean}");
    }

    #[test]
    fn unit_numbers_are_below_one() {
        assert!(unit(u64::MAX) < 1.0 && unit_f32(u64::MAX) < 1.0);
        assert!(unit(0) == 0.0 && unit_f32(0) == 0.0);
    }

    #[test]
    fn a_choice_is_one_of_several() {
        let mut random = Random::from_seed(3);
        assert!((0..100).all(|_| [1, 2, 3].contains(random.choice(&[1, 2, 3]).unwrap())));
        assert_eq!(random.choice::<u8>(&[]), None);
    }

    #[test]
    fn a_shuffle_is_a_permutation_and_every_place_is_as_likely() {
        let mut counts = [[0_u32; 5]; 5];
        let mut random = Random::from_seed(7);
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
    fn normal_numbers_have_mean_0_and_variance_1() {
        let mut random = Random::from_seed(1);
        let n = 20_000;
        let moments = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / f64::from(n);
            let squares = values.iter().map(|x| x * x).sum::<f64>() / f64::from(n);
            (mean, squares - mean * mean)
        };
        let double: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        let single: Vec<f64> = (0..n).map(|_| random.normal_f32().into()).collect();
        for (mean, variance) in [moments(&double), moments(&single)] {
            assert!(
                mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05,
                "{mean} {variance}"
            );
        }
    }
}
