//! The Castagnoli checksum, with which LevelDB guards its blocks and log records.
//!
//! Written out because the engine checks it only where it happens to read, and
//! tells nobody when it fails; see [`crate::verified_files`].

/// Reflected Castagnoli polynomial.
const POLYNOMIAL: u32 = 0x82f6_3b78;

/// What LevelDB adds to a stored checksum, so that a checksum over bytes that
/// contain checksums stays useful.
const MASK_DELTA: u32 = 0xa282_ead8;

/// `TABLES[k][b]`: the checksum of byte `b` followed by `k` zero bytes.
static TABLES: [[u32; 256]; 8] = tables();

const fn tables() -> [[u32; 256]; 8] {
    let mut tables = [[0; 256]; 8];
    let mut byte = 0;
    while byte < 256 {
        let mut crc = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            crc = (crc >> 1) ^ (POLYNOMIAL * (crc & 1));
            bit += 1;
        }
        tables[0][byte] = crc;
        byte += 1;
    }
    let mut k = 1;
    while k < 8 {
        let mut byte = 0;
        while byte < 256 {
            let before = tables[k - 1][byte];
            tables[k][byte] = (before >> 8) ^ tables[0][(before & 0xff) as usize];
            byte += 1;
        }
        k += 1;
    }
    tables
}

/// The checksum of `parts` one after the other.
pub(crate) fn crc32c(parts: &[&[u8]]) -> u32 {
    !parts.iter().fold(!0, |crc, part| extend(crc, part))
}

/// Eight bytes at a time ("slicing by eight", Kounavis and Berry 2005).
fn extend(mut crc: u32, bytes: &[u8]) -> u32 {
    let (chunks, rest) = bytes.as_chunks::<8>();
    for c in chunks {
        let low = crc ^ u32::from_le_bytes([c[0], c[1], c[2], c[3]]);
        let [l0, l1, l2, l3] = low.to_le_bytes();
        crc = TABLES[7][l0 as usize]
            ^ TABLES[6][l1 as usize]
            ^ TABLES[5][l2 as usize]
            ^ TABLES[4][l3 as usize]
            ^ TABLES[3][c[4] as usize]
            ^ TABLES[2][c[5] as usize]
            ^ TABLES[1][c[6] as usize]
            ^ TABLES[0][c[7] as usize];
    }
    for &byte in rest {
        crc = (crc >> 8) ^ TABLES[0][((crc ^ byte as u32) & 0xff) as usize];
    }
    crc
}

/// A checksum in the making, of bytes whose number is not known yet.
pub(crate) struct Running(u32);

impl Default for Running {
    fn default() -> Self {
        Self(!0)
    }
}

impl Running {
    pub(crate) fn push(&mut self, byte: u8) {
        self.0 = extend(self.0, &[byte]);
    }

    /// The checksum of all bytes so far and one more.
    pub(crate) fn with(&self, byte: u8) -> u32 {
        !extend(self.0, &[byte])
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
        assert_eq!(crc32c(&[b"123456789"]), 0xe306_9283);
    }

    #[test]
    fn parts_are_one_after_the_other() {
        let bytes: Vec<u8> = (0..=255).collect();
        for cut in [0, 1, 7, 8, 9, 100, 256] {
            let (head, tail) = bytes.split_at(cut);
            assert_eq!(crc32c(&[head, tail]), crc32c(&[&bytes]));
        }
    }

    #[test]
    fn a_running_checksum_is_that_of_all_its_bytes() {
        let mut running = Running::default();
        b"12345678".iter().for_each(|byte| running.push(*byte));
        assert_eq!(running.with(b'9'), crc32c(&[b"123456789"]));
    }

    #[test]
    fn unmasking_inverts_the_mask() {
        for crc in [0, 1, 0xe306_9283, u32::MAX] {
            assert_eq!(unmask(crc.rotate_right(15).wrapping_add(MASK_DELTA)), crc);
        }
    }
}
