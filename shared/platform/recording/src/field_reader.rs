//! Reader of little-endian fields from bytes that may be damaged.

use crate::InvalidRecord;

/// Cursor over the fields of a message.
#[derive(Debug, Clone)]
pub(crate) struct FieldReader<'a> {
    rest: &'a [u8],
}

impl<'a> FieldReader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Bytes behind the fields read so far.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// Next `n` bytes, part of the field `name`.
    pub(crate) fn bytes(
        &mut self,
        n: usize,
        name: &'static str,
    ) -> Result<&'a [u8], InvalidRecord> {
        let (bytes, rest) = self
            .rest
            .split_at_checked(n)
            .ok_or(InvalidRecord::Cut(name))?;
        self.rest = rest;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self, name: &'static str) -> Result<[u8; N], InvalidRecord> {
        let (bytes, rest) = self
            .rest
            .split_first_chunk()
            .ok_or(InvalidRecord::Cut(name))?;
        self.rest = rest;
        Ok(*bytes)
    }

    pub(crate) fn u32(&mut self, name: &'static str) -> Result<u32, InvalidRecord> {
        self.array(name).map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self, name: &'static str) -> Result<u64, InvalidRecord> {
        self.array(name).map(u64::from_le_bytes)
    }

    pub(crate) fn i64(&mut self, name: &'static str) -> Result<i64, InvalidRecord> {
        self.array(name).map(i64::from_le_bytes)
    }

    /// Next `N` numbers, part of the field `name`.
    pub(crate) fn f64s<const N: usize>(
        &mut self,
        name: &'static str,
    ) -> Result<[f64; N], InvalidRecord> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f64::from_le_bytes(self.array(name)?);
        }
        Ok(numbers)
    }
}
