//! Fixed-size text field of a message.

use bytemuck::{Pod, Zeroable};
use iceoryx2::prelude::ZeroCopySend;

/// UTF-8 text of at most 128 bytes; bytes after `len` are zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable, ZeroCopySend)]
#[type_name("tabula.Text.v1")]
#[repr(C)]
pub struct Text {
    bytes: [u8; Text::CAPACITY],
    len: u32,
}

const _: () = assert!(size_of::<Text>() == 132);

impl Default for Text {
    fn default() -> Self {
        Self::zeroed()
    }
}

impl Text {
    /// Maximum length of the text, bytes.
    pub const CAPACITY: usize = 128;

    /// Creates a text, truncated at a character boundary if too long.
    pub fn truncated(text: &str) -> Self {
        let mut end = text.len().min(Self::CAPACITY);
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let mut held = Self {
            len: end as u32,
            ..Self::default()
        };
        held.bytes[..end].copy_from_slice(&text.as_bytes()[..end]);
        held
    }

    /// Text as a string slice; `None` when the bytes are not UTF-8 (torn or hostile memory).
    pub fn as_str(&self) -> Option<&str> {
        std::str::from_utf8(self.bytes.get(..self.len as usize)?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_cut_between_characters_only() {
        let long = "é".repeat(100);
        let held = Text::truncated(&long);
        assert_eq!(held.as_str(), Some("é".repeat(64).as_str()));
        let odd = format!("x{long}");
        assert_eq!(Text::truncated(&odd).as_str().map(str::len), Some(127));
        assert_eq!(Text::truncated("").as_str(), Some(""));
    }

    #[test]
    fn bytes_that_are_no_utf_8_are_none() {
        let mut torn = Text::truncated("mug");
        torn.len = 4000;
        assert_eq!(torn.as_str(), None);
        torn = Text::truncated("mug");
        torn.bytes[1] = 0xff;
        assert_eq!(torn.as_str(), None);
    }
}
