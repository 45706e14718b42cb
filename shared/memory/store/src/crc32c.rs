//! The Castagnoli checksum, with which LevelDB guards its blocks and log records.
//!
//! Checked here because the engine checks it only where it happens to read, and
//! tells nobody when it fails; see [`crate::verified_files`].

use crc32c::crc32c_append;

/// What LevelDB adds to a stored checksum, so that a checksum over bytes that
/// contain checksums stays useful.
const MASK_DELTA: u32 = 0xa282_ead8;

/// The checksum of `parts` one after the other.
pub(crate) fn crc32c(parts: &[&[u8]]) -> u32 {
    parts.iter().fold(0, |crc, part| crc32c_append(crc, part))
}

/// A checksum in the making, of bytes whose number is not known yet.
#[derive(Default)]
pub(crate) struct Running(u32);

impl Running {
    pub(crate) fn push(&mut self, byte: u8) {
        self.0 = crc32c_append(self.0, &[byte]);
    }

    /// The checksum of all bytes so far and one more.
    pub(crate) fn with(&self, byte: u8) -> u32 {
        crc32c_append(self.0, &[byte])
    }
}

/// The checksum as it was before LevelDB masked it for storage.
pub(crate) fn unmask(masked: u32) -> u32 {
    masked.wrapping_sub(MASK_DELTA).rotate_left(15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_published_check_values() {
        // RFC 3720, appendix B.4, and the usual check value of "123456789".
        assert_eq!(crc32c(&[&[0; 32]]), 0x8a91_36aa);
        assert_eq!(crc32c(&[&[0xff; 32]]), 0x62a8_ab43);
        assert_eq!(crc32c(&[b"1234", b"56789"]), 0xe306_9283);
    }

    #[test]
    fn a_running_checksum_is_that_of_all_its_bytes() {
        let mut running = Running::default();
        b"12345678".iter().for_each(|byte| running.push(*byte));
        assert_eq!(running.with(b'9'), 0xe306_9283);
    }

    #[test]
    fn unmasking_inverts_the_mask() {
        for crc in [0, 1, 0xe306_9283, u32::MAX] {
            assert_eq!(unmask(crc.rotate_right(15).wrapping_add(MASK_DELTA)), crc);
        }
    }
}
