//! Number types of point cloud and mesh files, in binary and in text.

/// Storage type of a number in a binary file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberType {
    /// Signed integer of 8 bits.
    I8,
    /// Signed integer of 16 bits.
    I16,
    /// Signed integer of 32 bits.
    I32,
    /// Signed integer of 64 bits.
    I64,
    /// Unsigned integer of 8 bits.
    U8,
    /// Unsigned integer of 16 bits.
    U16,
    /// Unsigned integer of 32 bits.
    U32,
    /// Unsigned integer of 64 bits.
    U64,
    /// Floating-point number of 32 bits.
    F32,
    /// Floating-point number of 64 bits.
    F64,
}

/// Byte order (endianness) of a binary number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

impl NumberType {
    /// Size of the number in a binary file, bytes.
    pub const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// True for integer number types.
    pub const fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// Reads a binary number at the start of `bytes`; 64-bit integers beyond 2^53 are rounded.
    /// `None` when there are too few bytes.
    #[inline]
    pub fn read(self, bytes: &[u8], order: ByteOrder) -> Option<f64> {
        let bits = read_bits(bytes, self.size(), order)?;
        Some(match self {
            Self::I8 => f64::from(bits as i8),
            Self::I16 => f64::from(bits as i16),
            Self::I32 => f64::from(bits as i32),
            Self::I64 => bits as i64 as f64,
            Self::U8 | Self::U16 | Self::U32 | Self::U64 => bits as f64,
            Self::F32 => f64::from(f32::from_bits(bits as u32)),
            Self::F64 => f64::from_bits(bits),
        })
    }

    /// Parses a number; `None` when the text is not a number of this type or is out of range. NaN
    /// and infinity are accepted.
    pub fn parse(self, text: &str) -> Option<f64> {
        match self {
            Self::F32 => text.parse::<f32>().ok().map(f64::from),
            Self::F64 => text.parse::<f64>().ok(),
            Self::I8 => text.parse::<i8>().ok().map(f64::from),
            Self::I16 => text.parse::<i16>().ok().map(f64::from),
            Self::I32 => text.parse::<i32>().ok().map(f64::from),
            Self::I64 => text.parse::<i64>().ok().map(|value| value as f64),
            Self::U8 => text.parse::<u8>().ok().map(f64::from),
            Self::U16 => text.parse::<u16>().ok().map(f64::from),
            Self::U32 => text.parse::<u32>().ok().map(f64::from),
            Self::U64 => text.parse::<u64>().ok().map(|value| value as f64),
        }
    }
}

/// Bits of a number of `size` <= 8 bytes.
#[inline]
pub fn read_bits(bytes: &[u8], size: usize, order: ByteOrder) -> Option<u64> {
    let mut raw = [0; 8];
    let number = raw.get_mut(..size)?;
    number.copy_from_slice(bytes.get(..size)?);
    if order == ByteOrder::Big {
        number.reverse();
    }
    Some(u64::from_le_bytes(raw))
}

/// Exact conversion to an index or count; `None` when the value is not a `u32`.
#[inline]
pub fn as_u32(value: f64) -> Option<u32> {
    let whole = value as u32;
    (f64::from(whole) == value).then_some(whole)
}

/// Excerpt of a file's text, shortened and escaped for printing.
pub fn excerpt(text: &str) -> String {
    const MAX_CHARACTERS: usize = 40;
    let mut shown: String = text
        .chars()
        .take(MAX_CHARACTERS)
        .flat_map(char::escape_debug)
        .collect();
    if text.chars().nth(MAX_CHARACTERS).is_some() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_byte_orders_read_what_was_written(value in any::<i16>(), real in any::<f64>()) {
            let (little, big) = (value.to_le_bytes(), value.to_be_bytes());
            let expected = Some(f64::from(value));
            prop_assert_eq!(NumberType::I16.read(&little, ByteOrder::Little), expected);
            prop_assert_eq!(NumberType::I16.read(&big, ByteOrder::Big), expected);
            let read = NumberType::F64.read(&real.to_be_bytes(), ByteOrder::Big).unwrap();
            prop_assert_eq!(read.to_bits(), real.to_bits());
        }

        #[test]
        fn whole_numbers_survive_and_others_do_not(value in any::<u32>(), part in 0.01..0.99) {
            prop_assert_eq!(as_u32(f64::from(value)), Some(value));
            prop_assert_eq!(as_u32(f64::from(value) + part), None);
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        for value in [-1.0, f64::NAN, f64::INFINITY, 4_294_967_296.0] {
            assert_eq!(as_u32(value), None);
        }
        assert_eq!(NumberType::U8.parse("256"), None);
        assert_eq!(NumberType::I8.parse("-128"), Some(-128.0));
        assert_eq!(NumberType::U32.parse("1.0"), None);
        assert!(NumberType::F32.parse("-nan").is_some_and(f64::is_nan));
        assert_eq!(NumberType::U64.read(&[0; 7], ByteOrder::Little), None);
    }

    #[test]
    fn excerpts_are_short_and_printable() {
        assert_eq!(excerpt("a\u{1b}b"), "a\\u{1b}b");
        assert!(excerpt(&"x".repeat(1000)).len() < 50);
    }
}
