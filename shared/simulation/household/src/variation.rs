//! Random parameters of an instance.

use crate::palette::{Rgb, jittered};
use random::{Random, mix64};

/// Random number stream that varies one instance.
#[derive(Debug, Clone)]
pub struct Variation {
    random: Random,
}

impl Variation {
    /// Stream of one instance of a category.
    pub fn of(category: &str, instance: u64) -> Self {
        // FNV-1a hash of the name, so that categories do not share their random numbers.
        let name = category
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        // Both are mixed: otherwise one instance's stream would be a shifted copy of another
        // one's.
        Self {
            random: Random::from_seed(mix64(name ^ mix64(instance))),
        }
    }

    /// Next 64 bits of the random stream.
    pub fn seed(&mut self) -> u64 {
        self.random.next_u64()
    }

    /// Uniform random value in `low..high`.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.random.unit_f32()
    }

    /// Uniform random value in `low..high` of each range, in their order.
    pub(crate) fn each_between<const N: usize>(&mut self, ranges: [(f32, f32); N]) -> [f32; N] {
        ranges.map(|(low, high)| self.between(low, high))
    }

    /// Uniform random integer in `low..=high`.
    pub fn count(&mut self, low: usize, high: usize) -> usize {
        low + (self.seed() % (high.saturating_sub(low) as u64 + 1)) as usize
    }

    /// Bernoulli trial: true with this probability.
    pub fn with_probability(&mut self, probability: f32) -> bool {
        self.between(0.0, 1.0) < probability
    }

    /// Uniform choice of an element; the default value for an empty slice.
    pub fn pick<T: Copy + Default>(&mut self, choices: &[T]) -> T {
        let last = choices.len().saturating_sub(1);
        choices
            .get(self.count(0, last))
            .copied()
            .unwrap_or_default()
    }

    /// Random colour close to one of a palette.
    pub(crate) fn color(&mut self, palette: &[Rgb]) -> Rgb {
        let color = self.pick(palette);
        let mut by = || self.between(-10.0, 10.0);
        let (common, own) = (by(), [by() * 0.5, by() * 0.5, by() * 0.5]);
        jittered(color, own.map(|own| own + common))
    }

    /// Random colours, each close to one of its palette, in their order.
    pub(crate) fn colors<const N: usize>(&mut self, palettes: [&[Rgb]; N]) -> [Rgb; N] {
        palettes.map(|palette| self.color(palette))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_values_cover_exactly_their_range() {
        let mut variation = Variation::of("mug", 3);
        let counts: Vec<usize> = (0..300).map(|_| variation.count(2, 5)).collect();
        for expected in 2..=5 {
            assert!(counts.contains(&expected));
        }
        assert!(counts.iter().all(|n| (2..=5).contains(n)));
        let values: Vec<f32> = (0..1000).map(|_| variation.between(-1.0, 3.0)).collect();
        assert!(values.iter().all(|x| (-1.0..3.0).contains(x)));
        let mean = values.iter().sum::<f32>() / 1000.0;
        assert!((mean - 1.0).abs() < 0.2, "{mean}");
        assert_eq!(variation.pick::<u8>(&[]), 0);
    }

    #[test]
    fn stream_depends_only_on_category_and_instance() {
        let first = |category, instance| Variation::of(category, instance).seed();
        assert_eq!(first("mug", 1), first("mug", 1));
        assert_ne!(first("mug", 1), first("mug", 2));
        assert_ne!(first("mug", 1), first("cup", 1));
    }

    #[test]
    fn streams_of_instances_do_not_overlap() {
        let stream = |instance| {
            let mut variation = Variation::of("mug", instance);
            (0..50).map(|_| variation.seed()).collect::<Vec<_>>()
        };
        let mut all: Vec<u64> = (0..50).flat_map(stream).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 2500);
    }
}
