//! Corruption of valid files, for robustness tests.

use proptest::prelude::*;
use proptest::sample::Index;

/// Corruption of a valid file: replaced, removed and repeated bytes, truncation.
#[derive(Debug, Clone)]
pub struct Corruption {
    replaced: Vec<(Index, u8)>,
    removed: Option<(Index, Index)>,
    repeated: Option<(Index, Index)>,
    truncated_at: Option<Index>,
}

impl Corruption {
    /// Corrupted copy of a file.
    pub fn apply(&self, file: &[u8]) -> Vec<u8> {
        let mut damaged = file.to_vec();
        for (at, byte) in &self.replaced {
            if !damaged.is_empty() {
                let at = at.index(damaged.len());
                damaged[at] = *byte;
            }
        }
        if let Some((from, to)) = self.removed {
            damaged.drain(range(from, to, damaged.len()));
        }
        if let Some((from, to)) = self.repeated {
            damaged.extend_from_within(range(from, to, damaged.len()));
        }
        if let Some(at) = self.truncated_at {
            damaged.truncate(at.index(damaged.len() + 1));
        }
        damaged
    }
}

fn range(from: Index, to: Index, length: usize) -> std::ops::Range<usize> {
    let (from, to) = (from.index(length + 1), to.index(length + 1));
    from.min(to)..from.max(to)
}

/// Strategy for corruptions, biased towards digits in text.
pub fn corruption() -> impl Strategy<Value = Corruption> {
    let text = prop::sample::select(b"0123456789 \n-.e#".to_vec());
    let replaced = prop::collection::vec((any::<Index>(), prop_oneof![text, any::<u8>()]), 0..4);
    let piece = || prop::option::weighted(0.2, any::<(Index, Index)>());
    (
        replaced,
        piece(),
        piece(),
        prop::option::weighted(0.3, any::<Index>()),
    )
        .prop_map(|(replaced, removed, repeated, truncated_at)| Corruption {
            replaced,
            removed,
            repeated,
            truncated_at,
        })
}

/// Checks that an error message is one printable line of reasonable length.
///
/// # Panics
/// When it is not.
#[track_caller]
pub fn assert_sentence(error: &dyn std::error::Error) {
    let text = error.to_string();
    assert!(
        text.contains(' ') && text.len() > 20 && text.len() < 500,
        "{text:?}"
    );
    assert!(!text.contains(char::is_control), "{text:?}");
}

/// Truncations of a file at every byte.
pub fn truncations(file: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    (0..file.len()).map(|length| file[..length].to_vec())
}

/// Copies of a file with each of its bits flipped in turn.
pub fn flipped_bits(file: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    (0..8 * file.len()).map(|bit| {
        let mut flipped = file.to_vec();
        flipped[bit / 8] ^= 1 << (bit % 8);
        flipped
    })
}
