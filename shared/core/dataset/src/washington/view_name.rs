//! Names of Washington views.

use std::cmp::Ordering;
use std::fmt;

/// Maximum length of a category name, bytes.
const MAX_CATEGORY_BYTES: usize = 100;

/// Name of a view: `<category>_<instance>_<sequence>_<frame>`. The category may contain
/// underscores and numbers.
///
/// Names are ordered by category in natural order, then by their numbers.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct ViewName {
    category: String,
    instance: u32,
    sequence: u32,
    frame: u32,
}

impl ViewName {
    /// Creates a name. `None` when the category is empty, has characters other than letters,
    /// digits, `_` and `-`, or is longer than 100 bytes: it is used as a folder name.
    pub fn new(category: &str, instance: u32, sequence: u32, frame: u32) -> Option<Self> {
        let is_allowed =
            |character: char| character.is_alphanumeric() || matches!(character, '_' | '-');
        let is_name =
            (1..=MAX_CATEGORY_BYTES).contains(&category.len()) && category.chars().all(is_allowed);
        is_name.then(|| Self {
            category: category.to_owned(),
            instance,
            sequence,
            frame,
        })
    }

    /// Parses a displayed name from its end; `None` when invalid.
    pub fn parse(text: &str) -> Option<Self> {
        let mut parts = text.rsplitn(4, '_');
        let (frame, sequence) = (number(parts.next()?)?, number(parts.next()?)?);
        let (instance, category) = (number(parts.next()?)?, parts.next()?);
        Self::new(category, instance, sequence, frame)
    }

    /// Category name, such as `cell_phone`.
    pub fn category(&self) -> &str {
        &self.category
    }

    /// Instance number within the category, from 1 in the dataset.
    pub fn instance(&self) -> u32 {
        self.instance
    }

    /// Sequence number: a turn of the turntable; 1, 2 and 4 in the dataset, each at another camera
    /// elevation.
    pub fn sequence(&self) -> u32 {
        self.sequence
    }

    /// Frame number within the sequence, from 1 in the dataset.
    pub fn frame(&self) -> u32 {
        self.frame
    }
}

/// Parses a number without sign and leading zeros, so that a name maps back to its file.
fn number(text: &str) -> Option<u32> {
    let is_plain = text == "0" || matches!(text.as_bytes(), [b'1'..=b'9', ..]);
    text.parse().ok().filter(|_| is_plain)
}

impl fmt::Display for ViewName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            category,
            instance,
            sequence,
            frame,
        } = self;
        write!(f, "{category}_{instance}_{sequence}_{frame}")
    }
}

impl Ord for ViewName {
    fn cmp(&self, other: &Self) -> Ordering {
        let numbers = |name: &Self| (name.instance, name.sequence, name.frame);
        file_access::natural_order(&self.category, &other.category)
            .then_with(|| numbers(self).cmp(&numbers(other)))
    }
}

impl PartialOrd for ViewName {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_category_may_have_underscores() {
        let name = ViewName::parse("cell_phone_1_2_100").unwrap();
        assert_eq!(name, ViewName::new("cell_phone", 1, 2, 100).unwrap());
        assert_eq!((name.category(), name.instance()), ("cell_phone", 1));
        assert_eq!((name.sequence(), name.frame()), (2, 100));
    }

    #[test]
    fn other_names_are_rejected() {
        for text in [
            "",
            "apple",
            "apple_1_1",
            "_1_1_1",
            "apple_1_1_01",
            "apple_1_1_+1",
            "apple_1_1_-1",
            "apple_1_1_",
            "apple_1_1_4294967296",
            "../apple_1_1_1",
            "a.b_1_1_1",
            "a b_1_1_1",
            "apple_1_1_1_crop",
        ] {
            assert_eq!(ViewName::parse(text), None, "{text}");
        }
        assert_eq!(ViewName::new(&"x".repeat(101), 1, 1, 1), None);
    }

    proptest! {
        #[test]
        fn a_name_is_read_as_displayed(category in "[a-z0-9_é-]{1,12}", n in any::<[u32; 3]>()) {
            let name = ViewName::new(&category, n[0], n[1], n[2]).unwrap();
            prop_assert_eq!(ViewName::parse(&name.to_string()), Some(name));
        }

        #[test]
        fn parsed_names_are_displayed_unchanged(text in "[a-c_]{0,3}_?[0-9]{0,2}_[0-9]{1,2}_[0-9]") {
            if let Some(name) = ViewName::parse(&text) {
                prop_assert_eq!(name.to_string(), text);
            }
        }
    }
}
