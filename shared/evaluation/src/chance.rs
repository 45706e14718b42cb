//! A stream of chance for each use.

use random::{Random, mixed};

/// The stream of a purpose: a new use of chance does not shift the others.
pub(crate) fn stream(seed: u64, purpose: u64) -> Random {
    // The seed is mixed first, or one seed's stream were another's of another purpose.
    Random::from_seed(mixed(mixed(seed) ^ purpose))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_depend_on_seed_and_purpose() {
        let first = |seed, purpose| stream(seed, purpose).next_u64();
        let all = [first(1, 0), first(0, 1), first(1, 1), first(2, 0)];
        assert!((0..4).all(|i| (0..i).all(|j| all[i] != all[j])), "{all:?}");
        assert_eq!(first(1, 0), first(1, 0));
    }
}
