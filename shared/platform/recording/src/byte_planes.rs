//! Byte shuffle: a sequence of 32-bit words as four planes of bytes, which compress better.

/// Bytes of a word.
const WORD_BYTES: usize = 4;

/// Number of bytes of the planes of `n_words` words.
pub(crate) const fn plane_bytes(n_words: usize) -> usize {
    n_words * WORD_BYTES
}

/// Appends the planes of `n_words` words, the least significant bytes first.
pub(crate) fn append(n_words: usize, words: impl Iterator<Item = u32>, out: &mut Vec<u8>) {
    let begin = out.len();
    out.resize(begin + plane_bytes(n_words), 0);
    let (plane_0, rest) = out[begin..].split_at_mut(n_words);
    let (plane_1, rest) = rest.split_at_mut(n_words);
    let (plane_2, plane_3) = rest.split_at_mut(n_words);
    let planes = plane_0
        .iter_mut()
        .zip(plane_1)
        .zip(plane_2.iter_mut().zip(plane_3));
    for (word, ((byte_0, byte_1), (byte_2, byte_3))) in words.zip(planes) {
        [*byte_0, *byte_1, *byte_2, *byte_3] = word.to_le_bytes();
    }
}

/// Words of planes of equal length; bytes beyond a multiple of four are ignored.
pub(crate) fn words(planes: &[u8]) -> impl ExactSizeIterator<Item = u32> + '_ {
    let n_words = planes.len() / WORD_BYTES;
    let plane = |i: usize| planes[i * n_words..(i + 1) * n_words].iter();
    let pairs = plane(0).zip(plane(1)).zip(plane(2).zip(plane(3)));
    pairs.map(|((byte_0, byte_1), (byte_2, byte_3))| {
        u32::from_le_bytes([*byte_0, *byte_1, *byte_2, *byte_3])
    })
}

/// Replaces the bytes of each plane by their differences from the byte before, which are small
/// where neighbouring words are alike.
pub(crate) fn to_differences(planes: &mut [u8]) {
    let n_words = planes.len() / WORD_BYTES;
    for plane in planes.chunks_exact_mut(n_words.max(1)) {
        let mut before = 0;
        for byte in plane {
            let value = *byte;
            *byte = value.wrapping_sub(before);
            before = value;
        }
    }
}

/// Words of planes that were replaced by differences.
pub(crate) fn words_of_differences(planes: &[u8]) -> impl ExactSizeIterator<Item = u32> + '_ {
    let mut word = [0_u8; WORD_BYTES];
    words(planes).map(move |difference| {
        for (byte, difference) in word.iter_mut().zip(difference.to_le_bytes()) {
            *byte = byte.wrapping_add(difference);
        }
        u32::from_le_bytes(word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn planes_begin_with_the_least_significant_bytes() {
        let mut planes = vec![9];
        append(2, [0x0403_0201, 0x1413_1211].into_iter(), &mut planes);
        assert_eq!(planes, [9, 1, 0x11, 2, 0x12, 3, 0x13, 4, 0x14]);
    }

    proptest! {
        #[test]
        fn planes_give_their_words_back(given: Vec<u32>) {
            let mut planes = Vec::new();
            append(given.len(), given.iter().copied(), &mut planes);
            prop_assert_eq!(planes.len(), plane_bytes(given.len()));
            prop_assert_eq!(words(&planes).collect::<Vec<_>>(), given.clone());
            to_differences(&mut planes);
            prop_assert_eq!(words_of_differences(&planes).collect::<Vec<_>>(), given);
        }
    }
}
