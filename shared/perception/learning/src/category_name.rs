//! Validated category name.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Largest length of a name, bytes of UTF-8.
const MAX_BYTES: usize = 64;

/// Category name given by a person; cheap to clone.
///
/// Leading and trailing white space is removed and inner runs become one space. Names
/// are otherwise compared as text, with case. Serialised as text and validated on
/// reading.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct CategoryName(Arc<str>);

/// Error of an invalid category name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidCategoryName {
    /// Category name without visible characters.
    #[error("the category has no name: give it one, \"mug\" for example")]
    Empty,
    /// Category name of more than 64 bytes.
    #[error("the name of the category is {n_bytes} bytes long: use {MAX_BYTES} at most")]
    TooLong {
        /// Length of the category name, bytes.
        n_bytes: usize,
    },
    /// Invisible character, or one that changes the writing direction.
    #[error(
        "the name of the category contains the invisible character U+{:04X}: remove it",
        u32::from(*character)
    )]
    Invisible {
        /// Rejected character of the category name.
        character: char,
    },
}

impl CategoryName {
    /// Validated name from user input or a file.
    ///
    /// # Errors
    /// When nothing or more than 64 bytes remain after removing surplus white space, or
    /// when the text contains a control character or an invisible one.
    pub fn new(text: &str) -> Result<Self, InvalidCategoryName> {
        let text = text.trim();
        if let Some(character) = text.chars().find(|&c| is_invisible(c)) {
            return Err(InvalidCategoryName::Invisible { character });
        }
        let n_bytes = normalised_pieces(text).map(str::len).sum();
        match n_bytes {
            0 => Err(InvalidCategoryName::Empty),
            1..=MAX_BYTES => Ok(Self(normalised_pieces(text).collect::<String>().into())),
            _ => Err(InvalidCategoryName::TooLong { n_bytes }),
        }
    }

    /// Category name as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Words of the name, separated by single spaces.
fn normalised_pieces(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace()
        .enumerate()
        .flat_map(|(i, word)| [if i == 0 { "" } else { " " }, word])
}

/// True for control characters, line separators, direction marks and overrides, and
/// zero-width characters other than the joiners that some scripts need.
fn is_invisible(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}'
            | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

impl AsRef<str> for CategoryName {
    fn as_ref(&self) -> &str {
        self.as_str()
    }
}

impl From<CategoryName> for String {
    fn from(name: CategoryName) -> Self {
        name.as_str().to_owned()
    }
}

impl TryFrom<String> for CategoryName {
    type Error = InvalidCategoryName;

    fn try_from(text: String) -> Result<Self, InvalidCategoryName> {
        Self::new(&text)
    }
}

impl TryFrom<&str> for CategoryName {
    type Error = InvalidCategoryName;

    fn try_from(text: &str) -> Result<Self, InvalidCategoryName> {
        Self::new(text)
    }
}

impl std::str::FromStr for CategoryName {
    type Err = InvalidCategoryName;

    fn from_str(text: &str) -> Result<Self, InvalidCategoryName> {
        Self::new(text)
    }
}

impl fmt::Display for CategoryName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn surplus_white_space_is_removed() {
        for text in [
            "coffee jug",
            "  coffee jug\n",
            "coffee  \u{a0} jug",
            "\u{3000}coffee jug",
        ] {
            assert_eq!(CategoryName::new(text).unwrap().as_str(), "coffee jug");
        }
        assert_ne!(CategoryName::new("Mug"), CategoryName::new("mug"));
        assert_eq!(
            CategoryName::new("чашка ☕").unwrap().to_string(),
            "чашка ☕"
        );
    }

    #[test]
    fn the_longest_name_has_64_bytes() {
        assert!(CategoryName::new(&"x".repeat(64)).is_ok());
        assert!(CategoryName::new(&format!(" {} ", "ü".repeat(32))).is_ok());
        for (text, n_bytes) in [("x".repeat(300), 300), ("ü".repeat(33), 66)] {
            assert_eq!(
                CategoryName::new(&text),
                Err(InvalidCategoryName::TooLong { n_bytes })
            );
        }
    }

    #[test]
    fn empty_and_invisible_names_are_rejected() {
        for text in ["", " ", "\n\t\r", "\u{3000}"] {
            assert_eq!(CategoryName::new(text), Err(InvalidCategoryName::Empty));
        }
        let check = |character: char| {
            let refused = CategoryName::new(&format!("mug{character}s"));
            assert_eq!(refused, Err(InvalidCategoryName::Invisible { character }));
            assert!(refused.unwrap_err().to_string().contains("U+"));
        };
        "\0\n\t\u{1b}\u{7f}\u{85}\u{200b}\u{202e}\u{2066}\u{feff}"
            .chars()
            .for_each(check);
    }

    proptest! {
        #[test]
        fn a_valid_name_parses_to_itself(text in any::<String>()) {
            if let Ok(name) = CategoryName::new(&text) {
                prop_assert!((1..=64).contains(&name.as_str().len()));
                prop_assert_eq!(CategoryName::new(name.as_str()), Ok(name));
            }
        }
    }
}
