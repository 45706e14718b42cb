//! LZF compression, as used in `binary_compressed` PCD files.
//!
//! The format (Marc Lehmann, `LibLZF`): a control byte below 32 is followed by
//! that many literal bytes plus one; otherwise its upper three bits are a
//! length, 7 meaning that another length byte follows, and its lower five bits
//! and the next byte are how far back, less one, the `length + 2` bytes to
//! repeat begin.

/// Maximum expansion factor: three bytes of input give 264 bytes.
pub(crate) const MAX_EXPANSION: usize = MAX_MATCH / 3;

const MAX_LITERALS: usize = 32;
const MIN_MATCH: usize = 3;
const MAX_MATCH: usize = 264;
const MAX_OFFSET: usize = 1 << 13;

/// Copy granularity, bytes. Runs are copied in whole blocks and may overrun into bytes that are
/// written next.
const BLOCK: usize = 16;
/// Reserve for overruns after the end of the output, bytes.
const SLACK: usize = 2 * BLOCK;

/// Error of LZF decompression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Compressed input that ends inside a run.
    #[error("the compressed data ends inside a run; copy the file again")]
    Truncated,
    /// Back reference to before the start of the output.
    #[error("the compressed data repeats bytes from before its start; the file is damaged")]
    ReachesBack,
    /// Decompressed output longer than announced.
    #[error("the compressed data is longer than announced; the file is damaged")]
    TooLong,
    /// Decompressed output shorter than announced.
    #[error("the compressed data is shorter than announced; the file is damaged")]
    TooShort,
}

/// Decompresses `input` into exactly `n_bytes` at the start of the scratch buffer. The buffer
/// grows when needed, never shrinks, and has unspecified content after them.
///
/// The caller checks `n_bytes` against `MAX_EXPANSION` before.
///
/// # Errors
/// When the input is not LZF or does not expand to `n_bytes`.
pub(crate) fn decompress(input: &[u8], n_bytes: usize, scratch: &mut Vec<u8>) -> Result<(), Error> {
    if scratch.len() < n_bytes + SLACK {
        scratch.resize(n_bytes + SLACK, 0);
    }
    let out = &mut scratch[..n_bytes + SLACK];
    let (mut from, mut to) = (0, 0);
    while let Some(&control) = input.get(from) {
        from += 1;
        if usize::from(control) < MAX_LITERALS {
            let length = usize::from(control) + 1;
            check_room(to, length, n_bytes)?;
            copy_literals(&input[from..], length, &mut out[to..])?;
            (from, to) = (from + length, to + length);
        } else {
            let (length, offset, n_read) = read_match(control, &input[from..])?;
            check_room(to, length, n_bytes)?;
            if offset > to {
                return Err(Error::ReachesBack);
            }
            repeat(&mut out[to - offset..], offset, length);
            (from, to) = (from + n_read, to + length);
        }
    }
    if to == n_bytes {
        Ok(())
    } else {
        Err(Error::TooShort)
    }
}

#[inline]
fn check_room(to: usize, length: usize, n_bytes: usize) -> Result<(), Error> {
    if length <= n_bytes - to {
        Ok(())
    } else {
        Err(Error::TooLong)
    }
}

/// Length and offset of a back reference, and the number of bytes after the control byte that
/// encode it.
#[inline]
fn read_match(control: u8, input: &[u8]) -> Result<(usize, usize, usize), Error> {
    let offset_high = usize::from(control & 0x1f) << 8;
    match (control >> 5, input) {
        (7, [more, offset_low, ..]) => Ok((
            usize::from(*more) + 9,
            (offset_high | usize::from(*offset_low)) + 1,
            2,
        )),
        (length @ 1..=6, [offset_low, ..]) => Ok((
            usize::from(length) + 2,
            (offset_high | usize::from(*offset_low)) + 1,
            1,
        )),
        _ => Err(Error::Truncated),
    }
}

/// Copies up to 32 literals; a whole block of 32 where both sides allow it, since a copy of
/// constant length is a pair of instructions.
#[inline]
fn copy_literals(input: &[u8], length: usize, out: &mut [u8]) -> Result<(), Error> {
    let block = input.first_chunk::<MAX_LITERALS>();
    if let (Some(block), Some(target)) = (block, out.first_chunk_mut::<MAX_LITERALS>()) {
        *target = *block;
        return Ok(());
    }
    out[..length].copy_from_slice(input.get(..length).ok_or(Error::Truncated)?);
    Ok(())
}

/// Extends a run: repeats the bytes at the start of `out` so that `length` more follow the
/// first `offset`; overruns by less than a block.
#[inline]
fn repeat(out: &mut [u8], offset: usize, length: usize) {
    let end = offset + length;
    let mut at = offset;
    if offset >= BLOCK {
        while at < end {
            let (before, after) = out.split_at_mut(at);
            copy_block(&before[at - offset..], after);
            at += BLOCK;
        }
        return;
    }
    // A shorter offset is repeated block by block from a register, since its bytes
    // would be read before they are written.
    let (pattern, step) = pattern(out, offset);
    while at < end {
        copy_block(&pattern, &mut out[at..]);
        at += step;
    }
}

/// Block filled with the first `period` bytes repeatedly, and the largest multiple of the
/// period in it.
#[inline]
fn pattern(bytes: &[u8], period: usize) -> ([u8; BLOCK], usize) {
    let mut block = [0; BLOCK];
    copy_block(bytes, &mut block);
    let mut pattern = u128::from_le_bytes(block) & !(u128::MAX << (8 * period));
    let mut width = period;
    while width < BLOCK {
        pattern |= pattern << (8 * width);
        width *= 2;
    }
    (pattern.to_le_bytes(), BLOCK - BLOCK % period)
}

/// Copies a block; with constant length this is one instruction per side.
#[inline]
fn copy_block(from: &[u8], to: &mut [u8]) {
    if let (Some(from), Some(to)) = (from.first_chunk::<BLOCK>(), to.first_chunk_mut::<BLOCK>()) {
        *to = *from;
    }
}

/// Greedy compression; incompressible input grows by one byte in 32.
pub(crate) fn compress(input: &[u8]) -> Vec<u8> {
    let mut output = Vec::with_capacity(input.len() / 2);
    // Last position of each hash, plus one.
    let mut seen = vec![0_usize; 1 << HASH_BITS];
    let (mut literals_from, mut at) = (0, 0);
    while let Some(three) = input[at..].first_chunk::<MIN_MATCH>() {
        let last_seen = std::mem::replace(&mut seen[hash(*three)], at + 1);
        let length = match last_seen.checked_sub(1) {
            Some(earlier) if at - earlier <= MAX_OFFSET => common_length(input, earlier, at),
            _ => 0,
        };
        if length < MIN_MATCH {
            at += 1;
            continue;
        }
        push_literals(&input[literals_from..at], &mut output);
        push_match(length, at + 1 - last_seen, &mut output);
        at += length;
        literals_from = at;
    }
    push_literals(&input[literals_from..], &mut output);
    output
}

const HASH_BITS: u32 = 14;

fn hash([a, b, c]: [u8; MIN_MATCH]) -> usize {
    // Fibonacci hashing (Knuth, TAOCP 3, 6.4).
    (u32::from_le_bytes([a, b, c, 0]).wrapping_mul(0x9e37_79b1) >> (32 - HASH_BITS)) as usize
}

fn common_length(input: &[u8], earlier: usize, at: usize) -> usize {
    let longest = MAX_MATCH.min(input.len() - at);
    let pairs = input[earlier..].iter().zip(&input[at..at + longest]);
    pairs.take_while(|(left, right)| left == right).count()
}

fn push_literals(literals: &[u8], output: &mut Vec<u8>) {
    for run in literals.chunks(MAX_LITERALS) {
        output.push((run.len() - 1) as u8);
        output.extend_from_slice(run);
    }
}

fn push_match(length: usize, offset: usize, output: &mut Vec<u8>) {
    let [offset_high, offset_low] = ((offset - 1) as u16).to_be_bytes();
    match length - 2 {
        short @ 1..=6 => output.push((short as u8) << 5 | offset_high),
        long => output.extend([7 << 5 | offset_high, (long - 7) as u8]),
    }
    output.push(offset_low);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Reference decoder, byte by byte.
    fn decompress_slowly(input: &[u8]) -> Option<Vec<u8>> {
        let (mut out, mut bytes) = (Vec::new(), input.iter().copied());
        while let Some(control) = bytes.next() {
            if control < 32 {
                for _ in 0..=control {
                    out.push(bytes.next()?);
                }
                continue;
            }
            let mut length = usize::from(control >> 5);
            if length == 7 {
                length += usize::from(bytes.next()?);
            }
            let offset = (usize::from(control & 31) << 8 | usize::from(bytes.next()?)) + 1;
            for _ in 0..length + 2 {
                out.push(*out.get(out.len().checked_sub(offset)?)?);
            }
        }
        Some(out)
    }

    fn expand(input: &[u8], n_bytes: usize) -> Result<Vec<u8>, Error> {
        let mut scratch = vec![0xa5; 77];
        decompress(input, n_bytes, &mut scratch)?;
        scratch.truncate(n_bytes);
        Ok(scratch)
    }

    /// Test input with repetitions at short and long distances and of all lengths.
    fn repetitive() -> impl Strategy<Value = Vec<u8>> {
        let piece = (prop::collection::vec(0_u8..4, 1..40), 1_usize..60);
        prop::collection::vec(piece, 0..30).prop_map(|pieces| {
            pieces
                .into_iter()
                .flat_map(|(bytes, times)| bytes.repeat(times))
                .collect()
        })
    }

    proptest! {
        #[test]
        fn decompression_undoes_compression(input in repetitive(), noise in any::<Vec<u8>>()) {
            for bytes in [input, noise] {
                let compressed = compress(&bytes);
                prop_assert!(compressed.len() <= bytes.len() + bytes.len().div_ceil(MAX_LITERALS));
                prop_assert!(bytes.len() <= compressed.len() * MAX_EXPANSION);
                prop_assert_eq!(decompress_slowly(&compressed), Some(bytes.clone()));
                prop_assert_eq!(expand(&compressed, bytes.len()), Ok(bytes));
            }
        }

        #[test]
        fn any_input_does_what_the_format_says(input in any::<Vec<u8>>(), n_bytes in 0_usize..4000) {
            match decompress_slowly(&input) {
                Some(expected) => {
                    prop_assert_eq!(expand(&input, expected.len()), Ok(expected.clone()));
                    prop_assert_eq!(expand(&input, n_bytes).is_ok(), n_bytes == expected.len());
                }
                None => prop_assert!(expand(&input, n_bytes).is_err()),
            }
        }

        #[test]
        fn each_distance_and_length_repeats(
            start in prop::collection::vec(any::<u8>(), 32),
            offset in 1_usize..=32,
            length in MIN_MATCH..=MAX_MATCH,
        ) {
            let mut input = vec![31];
            input.extend(&start);
            push_match(length, offset, &mut input);
            let expected = decompress_slowly(&input).unwrap();
            prop_assert_eq!(expected.len(), 32 + length);
            prop_assert_eq!(expand(&input, 32 + length), Ok(expected));
        }
    }

    #[test]
    fn each_kind_of_damage_has_its_error() {
        assert_eq!(expand(&[5, 1, 2], 6), Err(Error::Truncated));
        assert_eq!(expand(&[0xe0, 1], 10), Err(Error::Truncated));
        assert_eq!(expand(&[0, 1, 0x20, 1], 4), Err(Error::ReachesBack));
        assert_eq!(expand(&[1, 1, 2], 1), Err(Error::TooLong));
        assert_eq!(expand(&[1, 1, 2], 3), Err(Error::TooShort));
    }
}
