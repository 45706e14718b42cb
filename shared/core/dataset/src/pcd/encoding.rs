//! Encoding of the points of a PCD file.

/// Encoding of the points after the header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// ASCII encoding: one line for each point.
    Ascii,
    /// Binary encoding: little-endian, point after point.
    Binary,
    /// LZF-compressed binary, field after field, preceded by the two sizes.
    BinaryCompressed,
}
