//! Plain CDR, version 1, little-endian: numbers aligned to their size, counted
//! from the end of the encapsulation header (OMG DDS-XTypes 1.3, 7.4.3).

/// Representation identifier of plain little-endian CDR, and no options.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Writes a message into bytes of its own.
pub struct Writer {
    bytes: Vec<u8>,
}

/// Reads what a [`Writer`] wrote. `None` when the bytes end too early or are no
/// such message.
pub struct Reader<'a> {
    body: &'a [u8],
    at: usize,
}

/// Bytes up to the next multiple of `alignment`.
fn padding(at: usize, alignment: usize) -> usize {
    at.next_multiple_of(alignment) - at
}

impl Writer {
    pub fn with_capacity(n_bytes: usize) -> Self {
        let mut bytes = Vec::with_capacity(n_bytes);
        bytes.extend(ENCAPSULATION);
        Self { bytes }
    }

    pub fn octet(&mut self, value: u8) {
        self.bytes.push(value);
    }

    pub fn unsigned(&mut self, value: u32) {
        let n_zeros = padding(self.bytes.len() - ENCAPSULATION.len(), size_of::<u32>());
        self.bytes.extend(&[0; size_of::<u32>()][..n_zeros]);
        self.bytes.extend(value.to_le_bytes());
    }

    /// Its length with the closing zero, its bytes, the zero.
    pub fn text(&mut self, value: &str) {
        self.unsigned(value.len() as u32 + 1);
        self.bytes.extend(value.as_bytes());
        self.bytes.push(0);
    }

    /// Its length, its bytes.
    pub fn octets(&mut self, values: &[u8]) {
        self.unsigned(values.len() as u32);
        self.bytes.extend(values);
    }

    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

impl<'a> Reader<'a> {
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let body = bytes.strip_prefix(&ENCAPSULATION)?;
        Some(Self { body, at: 0 })
    }

    pub fn octet(&mut self) -> Option<u8> {
        Some(self.take(1)?[0])
    }

    pub fn unsigned(&mut self) -> Option<u32> {
        self.take(padding(self.at, size_of::<u32>()))?;
        let bytes = self.take(size_of::<u32>())?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    }

    pub fn text(&mut self) -> Option<&'a str> {
        let n_bytes = self.unsigned()?;
        let (zero, text) = self.take(n_bytes as usize)?.split_last()?;
        (*zero == 0).then_some(())?;
        str::from_utf8(text).ok()
    }

    pub fn octets(&mut self) -> Option<&'a [u8]> {
        let n_bytes = self.unsigned()?;
        self.take(n_bytes as usize)
    }

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
    fn the_bytes_are_those_of_the_specification() {
        let mut writer = Writer::with_capacity(0);
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
    fn what_was_written_is_read() {
        let mut writer = Writer::with_capacity(64);
        writer.octet(1);
        writer.text("camera");
        writer.octets(&[1, 2, 3]);
        writer.unsigned(u32::MAX);
        let bytes = writer.finish();
        let mut reader = Reader::new(&bytes).unwrap();
        assert_eq!(reader.octet(), Some(1));
        assert_eq!(reader.text(), Some("camera"));
        assert_eq!(reader.octets(), Some(&[1, 2, 3][..]));
        assert_eq!(reader.unsigned(), Some(u32::MAX));
        assert_eq!(reader.octet(), None);
    }

    #[test]
    fn other_encapsulations_and_wrong_lengths_are_refused() {
        assert!(Reader::new(&[0, 0, 0, 0]).is_none(), "big-endian");
        assert!(Reader::new(&[0, 1]).is_none());
        let longer_than_all = [0, 1, 0, 0, 255, 255, 255, 255, 1];
        assert!(Reader::new(&longer_than_all).unwrap().octets().is_none());
        let without_zero = [0, 1, 0, 0, 1, 0, 0, 0, b'a'];
        assert!(Reader::new(&without_zero).unwrap().text().is_none());
    }
}
