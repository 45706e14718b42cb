//! CDR serialisation (plain, version 1, little-endian; OMG DDS-XTypes 1.3, 7.4.3).
//!
//! Numbers are aligned to their size, counted from the end of the encapsulation header.

/// Encapsulation header: representation identifier of plain little-endian CDR, no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// CDR encoder into a growing buffer.
pub struct CdrWriter {
    bytes: Vec<u8>,
}

/// CDR decoder of a buffer; its methods return `None` if the bytes are truncated or invalid.
pub struct CdrReader<'a> {
    body: &'a [u8],
    at: usize,
}

/// Padding up to the next multiple of `alignment`, bytes.
fn padding(at: usize, alignment: usize) -> usize {
    at.next_multiple_of(alignment) - at
}

impl CdrWriter {
    /// Encoder with the encapsulation header written.
    pub fn with_capacity(n_bytes: usize) -> Self {
        let mut bytes = Vec::with_capacity(n_bytes);
        bytes.extend(ENCAPSULATION);
        Self { bytes }
    }

    /// Writes an octet.
    pub fn octet(&mut self, value: u8) {
        self.bytes.push(value);
    }

    /// Writes an aligned unsigned long (32 bits).
    pub fn unsigned(&mut self, value: u32) {
        let n_zeros = padding(self.bytes.len() - ENCAPSULATION.len(), size_of::<u32>());
        self.bytes.extend(&[0; size_of::<u32>()][..n_zeros]);
        self.bytes.extend(value.to_le_bytes());
    }

    /// Writes a string: length with the terminating zero, bytes, zero.
    pub fn text(&mut self, value: &str) {
        self.unsigned(value.len() as u32 + 1);
        self.bytes.extend(value.as_bytes());
        self.bytes.push(0);
    }

    /// Writes a sequence of octets: length, bytes.
    pub fn octets(&mut self, values: &[u8]) {
        self.unsigned(values.len() as u32);
        self.bytes.extend(values);
    }

    /// Encoded bytes.
    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

impl<'a> CdrReader<'a> {
    /// Decoder after a valid encapsulation header.
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let body = bytes.strip_prefix(&ENCAPSULATION)?;
        Some(Self { body, at: 0 })
    }

    /// Reads an octet.
    pub fn octet(&mut self) -> Option<u8> {
        Some(self.take(1)?[0])
    }

    /// Reads an aligned unsigned long (32 bits).
    pub fn unsigned(&mut self) -> Option<u32> {
        self.take(padding(self.at, size_of::<u32>()))?;
        let bytes = self.take(size_of::<u32>())?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    }

    /// Reads a string.
    pub fn text(&mut self) -> Option<&'a str> {
        let n_bytes = self.unsigned()?;
        let (zero, text) = self.take(n_bytes as usize)?.split_last()?;
        (*zero == 0).then_some(())?;
        str::from_utf8(text).ok()
    }

    /// Reads a sequence of octets.
    pub fn octets(&mut self) -> Option<&'a [u8]> {
        let n_bytes = self.unsigned()?;
        self.take(n_bytes as usize)
    }

    /// Takes the next bytes.
    fn take(&mut self, n_bytes: usize) -> Option<&'a [u8]> {
        let taken = self.body.get(self.at..)?.get(..n_bytes)?;
        self.at += n_bytes;
        Some(taken)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoding_matches_the_specification() {
        let mut writer = CdrWriter::with_capacity(0);
        writer.text("ab");
        writer.unsigned(0x0102_0304);
        writer.octet(9);
        writer.octets(&[7, 8]);
        let expected = [
            0, 1, 0, 0, // plain, little-endian
            3, 0, 0, 0, b'a', b'b', 0, // with its zero
            0, 4, 3, 2, 1, // aligned
            9, 0, 0, 0, 2, 0, 0, 0, 7, 8,
        ];
        assert_eq!(writer.finish(), expected);
    }

    #[test]
    fn encoding_round_trips() {
        let mut writer = CdrWriter::with_capacity(64);
        writer.octet(1);
        writer.text("camera");
        writer.octets(&[1, 2, 3]);
        writer.unsigned(u32::MAX);
        let bytes = writer.finish();
        let mut reader = CdrReader::new(&bytes).unwrap();
        assert_eq!(reader.octet(), Some(1));
        assert_eq!(reader.text(), Some("camera"));
        assert_eq!(reader.octets(), Some(&[1, 2, 3][..]));
        assert_eq!(reader.unsigned(), Some(u32::MAX));
        assert_eq!(reader.octet(), None);
    }

    #[test]
    fn other_encapsulations_and_wrong_lengths_are_rejected() {
        assert!(CdrReader::new(&[0, 0, 0, 0]).is_none(), "big-endian");
        assert!(CdrReader::new(&[0, 1]).is_none());
        let longer_than_all = [0, 1, 0, 0, 255, 255, 255, 255, 1];
        assert!(CdrReader::new(&longer_than_all).unwrap().octets().is_none());
        let without_zero = [0, 1, 0, 0, 1, 0, 0, 0, b'a'];
        assert!(CdrReader::new(&without_zero).unwrap().text().is_none());
    }
}
