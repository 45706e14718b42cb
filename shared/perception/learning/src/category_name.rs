//! The name of a category.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Longest name, bytes of UTF-8.
const MAX_BYTES: usize = 64;

/// A name that a person gave to a category. Cheap to clone.
///
/// White space around the name is dropped and runs of it inside become one
/// space, so that what looks equal is equal. Apart from that, equal names are the
/// same text, letter for letter and with the same case: whoever uses a name as a
/// key may use either of two equal ones. Serialised as its text, and checked when
/// it is read back.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct CategoryName(Arc<str>);

/// Why a text can not be the name of a category.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum InvalidCategoryName {
    /// Nothing visible is in it.
    Empty,
    /// It is longer than 64 bytes.
    TooLong {
        /// Its length, bytes.
        n_bytes: usize,
    },
    /// It contains a character that can not be seen or that changes the direction
    /// of writing.
    Invisible {
        /// The character.
        character: char,
    },
}

impl CategoryName {
    /// A name from what a person typed or a file holds.
    ///
    /// # Errors
    /// When nothing or more than 64 bytes remain without surplus white space, or
    /// when there is a control character or an invisible one.
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

    /// The name as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// The words with one space between them.
fn normalised_pieces(text: &str) -> impl Iterator<Item = &str> {
    text.split_whitespace()
        .enumerate()
        .flat_map(|(i, word)| [if i == 0 { "" } else { " " }, word])
}

/// Control characters, line separators, marks and overrides of direction, and
/// characters without width except the joiners that some scripts need.
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

impl fmt::Display for InvalidCategoryName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => {
                f.write_str("the category has no name: give it one, \"mug\" for example")
            }
            Self::TooLong { n_bytes } => write!(
                f,
                "the name of the category is {n_bytes} bytes long: use {MAX_BYTES} at most"
            ),
            Self::Invisible { character } => write!(
                f,
                "the name of the category contains the invisible character U+{:04X}: remove it",
                u32::from(*character)
            ),
        }
    }
}

impl std::error::Error for InvalidCategoryName {}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn surplus_white_space_is_no_part_of_a_name() {
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
    fn what_can_not_be_read_is_refused() {
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
        fn a_name_is_made_of_its_own_text(text in any::<String>()) {
            if let Ok(name) = CategoryName::new(&text) {
                prop_assert!((1..=64).contains(&name.as_str().len()));
                prop_assert_eq!(CategoryName::new(name.as_str()), Ok(name));
            }
        }
    }
}
