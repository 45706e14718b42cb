//! CRC-32C (Castagnoli), the checksum of LevelDB blocks and log records.
//!
//! It is verified here because the engine verifies it only on some reads and does not report
//! failures; see [`crate::verified_files`].

use crc32c::crc32c_append;

/// Masking constant of LevelDB: a CRC over bytes that contain CRCs stays meaningful.
const MASK_DELTA: u32 = 0xa282_ead8;

/// CRC-32C of the concatenated parts.
pub(crate) fn crc32c(parts: &[&[u8]]) -> u32 {
    parts.iter().fold(0, |crc, part| crc32c_append(crc, part))
}

/// Incremental CRC-32C over bytes of unknown length.
#[derive(Default)]
pub(crate) struct IncrementalCrc(u32);

impl IncrementalCrc {
    pub(crate) fn push(&mut self, byte: u8) {
        self.0 = crc32c_append(self.0, &[byte]);
    }

    /// CRC-32C of all bytes so far and one more byte.
    pub(crate) fn with(&self, byte: u8) -> u32 {
        crc32c_append(self.0, &[byte])
    }
}

/// Masks a CRC for storing.
pub(crate) fn mask(crc: u32) -> u32 {
    crc.rotate_right(15).wrapping_add(MASK_DELTA)
}

/// Unmasks a stored CRC.
pub(crate) fn unmask(masked: u32) -> u32 {
    masked.wrapping_sub(MASK_DELTA).rotate_left(15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crc32c_equals_the_published_check_values() {
        // RFC 3720, appendix B.4, and the usual check value of "123456789".
        assert_eq!(crc32c(&[&[0; 32]]), 0x8a91_36aa);
        assert_eq!(crc32c(&[&[0xff; 32]]), 0x62a8_ab43);
        assert_eq!(crc32c(&[b"1234", b"56789"]), 0xe306_9283);
    }

    #[test]
    fn incremental_crc_equals_the_crc_of_all_bytes() {
        let mut running = IncrementalCrc::default();
        b"12345678".iter().for_each(|byte| running.push(*byte));
        assert_eq!(running.with(b'9'), 0xe306_9283);
    }

    #[test]
    fn unmask_inverts_the_mask() {
        for crc in [0, 1, 0xe306_9283, u32::MAX] {
            assert_eq!(unmask(mask(crc)), crc);
        }
    }
}
