//! Dictionary encoding of a plane by a table of its distinct words: sensors measure depth in a few
//! thousand steps, so that an index of 16 bits stands for a word of 32.

use crate::field_reader::FieldReader;
use crate::{InvalidRecord, byte_planes};

/// Largest number of words of a table. A Kinect has 2048 steps, an image in millimetres some
/// thousands.
const MAX_WORDS: usize = 16_384;
/// Slots of the hash table: twice as many, so that probing ends soon.
const N_SLOTS: usize = 2 * MAX_WORDS;
/// Multiplicative hash (Knuth, "The Art of Computer Programming", 6.4): 2^32 by the golden ratio.
const HASH_FACTOR: u32 = 2_654_435_769;

/// Hash table from words to their indices, with linear probing.
struct WordIndices {
    /// Word and index of each slot; an index of `u16::MAX` is an empty slot.
    slots: Vec<(u32, u16)>,
}

const EMPTY: u16 = u16::MAX;

impl WordIndices {
    fn new() -> Self {
        Self {
            slots: vec![(0, EMPTY); N_SLOTS],
        }
    }

    /// Slot of a word, or the empty slot for it.
    #[inline]
    fn slot(&self, word: u32) -> usize {
        let mut slot = (word.wrapping_mul(HASH_FACTOR) >> 17) as usize % N_SLOTS;
        while self.slots[slot].1 != EMPTY && self.slots[slot].0 != word {
            slot = (slot + 1) % N_SLOTS;
        }
        slot
    }
}

/// Appends the table of the distinct words, in ascending order, and the planes of the words'
/// indices in it. Returns false, and appends nothing, when there are too many distinct words.
pub(crate) fn append(words: impl Iterator<Item = u32> + Clone, out: &mut Vec<u8>) -> bool {
    let mut indices = WordIndices::new();
    let Some(table) = distinct_words(words.clone(), &mut indices) else {
        return false;
    };
    out.extend((table.len() as u32).to_le_bytes());
    for (index, &word) in (0..).zip(&table) {
        out.extend(word.to_le_bytes());
        let slot = indices.slot(word);
        indices.slots[slot].1 = index;
    }
    let index = |word| indices.slots[indices.slot(word)].1;
    let begin = out.len();
    out.extend(words.clone().map(|word| index(word) as u8));
    let n_words = out.len() - begin;
    out.extend(words.map(|word| (index(word) >> 8) as u8).take(n_words));
    true
}

/// Distinct words in ascending order; `None` when there are too many.
fn distinct_words(words: impl Iterator<Item = u32>, indices: &mut WordIndices) -> Option<Vec<u32>> {
    let mut table = Vec::new();
    for word in words {
        let slot = indices.slot(word);
        if indices.slots[slot].1 == EMPTY {
            if table.len() >= MAX_WORDS {
                return None;
            }
            indices.slots[slot] = (word, 0);
            table.push(word);
        }
    }
    table.sort_unstable();
    Some(table)
}

/// Table and planes of a message.
#[derive(Debug, Clone)]
pub(crate) struct WordTable<'a> {
    words: &'a [u8],
    indices: &'a [u8],
}

impl<'a> WordTable<'a> {
    /// Reads the table of `n_words` words.
    pub(crate) fn read(
        fields: &mut FieldReader<'a>,
        n_words: usize,
    ) -> Result<Self, InvalidRecord> {
        const NAME: &str = "depth table";
        let length = fields.u32(NAME)? as usize;
        if length > MAX_WORDS {
            return Err(InvalidRecord::TableLength(length));
        }
        Ok(Self {
            words: fields.bytes(byte_planes::plane_bytes(length), NAME)?,
            indices: fields.bytes(2 * n_words, "depth indices")?,
        })
    }

    /// Words; an index beyond the table stands for NaN.
    pub(crate) fn words(&self) -> impl Iterator<Item = u32> + '_ {
        let table: Vec<u32> = self
            .words
            .as_chunks()
            .0
            .iter()
            .map(|&bytes| u32::from_le_bytes(bytes))
            .collect();
        let (low, high) = self.indices.split_at(self.indices.len() / 2);
        let word = move |(&low, &high): (&u8, &u8)| {
            let word = table.get(usize::from(u16::from_le_bytes([low, high])));
            word.copied().unwrap_or(f32::NAN.to_bits())
        };
        low.iter().zip(high).map(word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn round_trip(given: &[u32]) -> Option<Vec<u32>> {
        let mut bytes = Vec::new();
        append(given.iter().copied(), &mut bytes).then(|| {
            let mut fields = FieldReader::new(&bytes);
            let table = WordTable::read(&mut fields, given.len()).unwrap();
            assert!(fields.rest().is_empty());
            table.words().collect()
        })
    }

    #[test]
    fn table_with_too_many_words_is_refused() {
        let words = |n: usize| {
            (0..n as u32)
                .map(|i| i.wrapping_mul(77_777))
                .collect::<Vec<_>>()
        };
        assert_eq!(round_trip(&words(MAX_WORDS)), Some(words(MAX_WORDS)));
        assert_eq!(round_trip(&words(MAX_WORDS + 1)), None);
    }

    proptest! {
        #[test]
        fn table_gives_its_words_back(given: Vec<u32>, pattern in 0_u32..40) {
            let repeated: Vec<u32> = given.iter().map(|word| word % (pattern + 1)).collect();
            prop_assert_eq!(round_trip(&repeated), Some(repeated));
            prop_assert_eq!(round_trip(&given), Some(given));
        }
    }
}
