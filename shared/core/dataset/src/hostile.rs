//! Damaged files for property tests.

use proptest::prelude::*;
use proptest::sample::Index;

/// What happens to a valid file.
#[derive(Debug, Clone)]
pub(crate) struct Damage {
    replaced: Vec<(Index, u8)>,
    removed: Option<(Index, Index)>,
    repeated: Option<(Index, Index)>,
    cut: Option<Index>,
}

impl Damage {
    pub(crate) fn apply(&self, file: &[u8]) -> Vec<u8> {
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
        if let Some(at) = self.cut {
            damaged.truncate(at.index(damaged.len() + 1));
        }
        damaged
    }
}

fn range(from: Index, to: Index, length: usize) -> std::ops::Range<usize> {
    let (from, to) = (from.index(length + 1), to.index(length + 1));
    from.min(to)..from.max(to)
}

/// Some damage, often to numbers in text.
pub(crate) fn damage() -> impl Strategy<Value = Damage> {
    let text = prop::sample::select(b"0123456789 \n-.e#".to_vec());
    let replaced = prop::collection::vec((any::<Index>(), prop_oneof![text, any::<u8>()]), 0..4);
    let piece = || prop::option::weighted(0.2, any::<(Index, Index)>());
    (
        replaced,
        piece(),
        piece(),
        prop::option::weighted(0.3, any::<Index>()),
    )
        .prop_map(|(replaced, removed, repeated, cut)| Damage {
            replaced,
            removed,
            repeated,
            cut,
        })
}

/// An error must tell a person something, on one line, in printable characters.
#[track_caller]
pub(crate) fn assert_sentence(error: &dyn std::error::Error) {
    let text = error.to_string();
    assert!(
        text.contains(' ') && text.len() > 20 && text.len() < 500,
        "{text:?}"
    );
    assert!(!text.contains(char::is_control), "{text:?}");
}

/// A file cut at every byte.
pub(crate) fn cuts(file: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    (0..file.len()).map(|length| file[..length].to_vec())
}

/// A file with each of its bits flipped in turn.
pub(crate) fn flipped_bits(file: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    (0..8 * file.len()).map(|bit| {
        let mut flipped = file.to_vec();
        flipped[bit / 8] ^= 1 << (bit % 8);
        flipped
    })
}
