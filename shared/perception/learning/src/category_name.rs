//! Validated category name.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;

/// Largest length of a name, bytes of UTF-8.
const MAX_BYTES: usize = 64;

/// Category name given by a person; cheap to clone.
///
/// A new name is in Unicode's normalization form C, without invisible characters; leading and
/// trailing white space is removed, and inner runs become one space. Names are compared as text,
/// with case. Serialised as text, and read as an earlier version may have stored it.
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
    /// Validated name from user input or a file, in normalization form C.
    ///
    /// # Errors
    /// When nothing or more than 64 bytes remain after removing surplus white space, or when the
    /// text contains an invisible character, except for a joiner between letters that it shapes.
    pub fn new(text: &str) -> Result<Self, InvalidCategoryName> {
        let text = unicode_text::nfc(text.trim());
        let is_hidden = |c: &char| unicode_text::is_invisible(*c) && !unicode_text::is_joiner(*c);
        let hidden = text.chars().find(is_hidden);
        if let Some(character) = hidden.or_else(|| unicode_text::joiner_out_of_place(&text)) {
            return Err(InvalidCategoryName::Invisible { character });
        }
        Self::spaced(&text)
    }

    /// Name as it was stored, perhaps by an earlier version, which accepted more.
    ///
    /// # Errors
    /// When nothing or more than 64 bytes remain after removing surplus white space, or when the
    /// text contains an unprintable character.
    pub fn stored(text: &str) -> Result<Self, InvalidCategoryName> {
        let text = text.trim();
        if let Some(character) = text.chars().find(|&c| is_unprintable_as_stored(c)) {
            return Err(InvalidCategoryName::Invisible { character });
        }
        Self::spaced(text)
    }

    /// Name with single spaces between its words, if it has a valid length.
    fn spaced(text: &str) -> Result<Self, InvalidCategoryName> {
        let n_bytes = normalised_pieces(text).map(str::len).sum();
        match n_bytes {
            0 => Err(InvalidCategoryName::Empty),
            1..=MAX_BYTES => Ok(Self(normalised_pieces(text).collect::<String>().into())),
            _ => Err(InvalidCategoryName::TooLong { n_bytes }),
        }
    }

    /// Name as it would be given today: in normalization form C, without invisible characters.
    ///
    /// A name of invisible characters only becomes their code points. The result is the name
    /// itself if it is valid today, or cannot be made so.
    #[must_use]
    pub fn normalised(&self) -> Self {
        let text = self.as_str();
        let visible = || text.chars().filter(|c| !unicode_text::is_invisible(*c));
        let code_points = || text.chars().map(|c| format!("U+{:04X}", u32::from(c)));
        let given = Self::new(text).or_else(|_| Self::new(&visible().collect::<String>()));
        let given = given.or_else(|_| Self::new(&code_points().collect::<Vec<_>>().join(" ")));
        given.unwrap_or_else(|_| self.clone())
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

/// True for characters that no version ever stored in a name.
fn is_unprintable_as_stored(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
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
        Self::stored(&text)
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
        let hidden = "\0\n\t\u{1b}\u{7f}\u{85}\u{200b}\u{202e}\u{2066}\u{feff}\
                      \u{115f}\u{3164}\u{ffa0}\u{34f}\u{180b}\u{200c}\u{200d}\u{fe0f}\u{e0041}";
        hidden.chars().for_each(check);
        // A joiner that shapes letters is seen.
        assert!(CategoryName::new("می\u{200c}خواهم").is_ok());
    }

    #[test]
    fn name_is_brought_into_the_normal_form() {
        let [composed, decomposed] = ["caf\u{e9}", "cafe\u{301}"].map(CategoryName::new);
        assert_eq!(composed, decomposed);
        assert_eq!(composed.unwrap().as_str(), "caf\u{e9}");
        // Its length is that of the normal form.
        assert!(CategoryName::new(&"e\u{301}".repeat(32)).is_ok());
    }

    #[test]
    fn stored_name_of_an_earlier_version_is_read_as_it_is() {
        for (text, today) in [
            ("cafe\u{301}", "caf\u{e9}"),
            ("mug\u{3164}", "mug"),
            ("mug\u{e0041}\u{fe0f}", "mug"),
            ("m\u{200c}ug", "mug"),
            ("\u{3164}\u{115f}", "U+3164 U+115F"),
            ("mug", "mug"),
        ] {
            let stored = CategoryName::try_from(text.to_owned()).unwrap();
            assert_eq!(stored.as_str(), text);
            assert_eq!(stored.normalised().as_str(), today);
        }
    }

    proptest! {
        #[test]
        fn a_valid_name_parses_to_itself(text in any::<String>()) {
            if let Ok(name) = CategoryName::new(&text) {
                prop_assert!((1..=64).contains(&name.as_str().len()));
                prop_assert_eq!(CategoryName::new(name.as_str()), Ok(name.clone()));
                prop_assert_eq!(CategoryName::stored(name.as_str()), Ok(name.clone()));
                prop_assert_eq!(name.normalised(), name);
            }
        }

        #[test]
        fn a_valid_name_has_no_invisible_character(text in "[a\u{e9}e\u{301}\u{200c}\u{644}\u{645}\u{3164}\u{fe0f}\u{e0041} ]{1,6}") {
            if let Ok(name) = CategoryName::new(&text) {
                let hidden = name.as_str().chars().find(|c| unicode_text::is_invisible(*c) && !unicode_text::is_joiner(*c));
                prop_assert_eq!(hidden, None);
                prop_assert_eq!(unicode_text::joiner_out_of_place(name.as_str()), None);
                prop_assert_eq!(unicode_text::nfc(name.as_str()), name.as_str());
            }
        }

        #[test]
        fn a_stored_name_has_a_valid_one(text in any::<String>()) {
            if let Ok(name) = CategoryName::stored(&text) {
                let today = name.normalised();
                prop_assert_eq!(today.normalised(), today);
            }
        }
    }
}
