//! Mutation fuzzing on the stable toolchain: a target is called with corruptions of valid inputs.
//!
//! Each run of the tests takes the same few thousand corruptions. With `TABULA_FUZZ_CASES` set to
//! a number it takes that many others, for a long run: `TABULA_FUZZ_CASES=10000000 cargo test
//! --release fuzz_`. A case that breaks its target is made smaller before it is printed.
//!
//! Invariants: only tests use this crate.
//!
//! # Example
//!
//! ```
//! let seeds = [b"1 2 3".to_vec(), b"4".to_vec()];
//! mutation_fuzzing::fuzz(&seeds, |bytes| {
//!     // Any bytes are parsed or refused, and never break the parser.
//!     let _ = std::str::from_utf8(bytes).map(str::parse::<u32>);
//! });
//! ```
#![expect(
    clippy::panic,
    reason = "a broken target fails the test that calls this"
)]

mod corruption;

pub use corruption::{Corruption, assert_sentence, corruption, flipped_bits, truncations};

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRng, TestRunner};

/// Corruptions in each run of the tests. Chosen: a second at most for each target.
const USUAL_CASES: u32 = 4000;
/// Variable with the number of corruptions of a long run.
const CASES: &str = "TABULA_FUZZ_CASES";

/// Calls a target with corruptions of the seeds, and with the seeds themselves. The target fails
/// by a panic.
///
/// # Panics
/// When the target does, with the smallest corrupted input that was found.
pub fn fuzz(seeds: &[Vec<u8>], target: impl Fn(&[u8])) {
    for seed in seeds {
        target(seed);
    }
    let wanted = std::env::var(CASES).ok();
    let cases = wanted.as_ref().map_or(USUAL_CASES, |cases| {
        let number = cases.parse();
        number.unwrap_or_else(|_| panic!("{CASES}={cases} is no number of corruptions"))
    });
    let config = Config {
        cases,
        failure_persistence: None,
        ..Config::default()
    };
    let algorithm = config.rng_algorithm;
    let mut runner = match wanted {
        None => TestRunner::new_with_rng(config, TestRng::deterministic_rng(algorithm)),
        Some(_) => TestRunner::new(config),
    };
    let corrupted = (prop::sample::select(seeds.to_vec()), corruption())
        .prop_map(|(seed, corruption)| corruption.apply(&seed));
    let outcome = runner.run(&corrupted, |bytes| {
        target(&bytes);
        Ok(())
    });
    if let Err(failure) = outcome {
        panic!("the target broke: {failure}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;
    use std::collections::BTreeSet;

    #[test]
    fn fuzz_calls_the_target_with_seeds_and_many_corruptions() {
        let seeds = [b"12345678".to_vec(), b"abc".to_vec()];
        let seen = RefCell::new(BTreeSet::new());
        fuzz(&seeds, |bytes| {
            seen.borrow_mut().insert(bytes.to_vec());
        });
        let seen = seen.into_inner();
        assert!(seeds.iter().all(|seed| seen.contains(seed)));
        assert!(seen.len() > 1000, "{}", seen.len());
    }

    #[test]
    #[should_panic(expected = "the target broke")]
    fn fuzz_finds_what_breaks_the_target() {
        fuzz(&[b"12345678".to_vec()], |bytes| {
            assert!(!bytes.contains(&b'#'), "a character that no seed has");
        });
    }
}
