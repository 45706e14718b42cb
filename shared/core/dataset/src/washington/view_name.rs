//! The names of views.

use std::cmp::Ordering;
use std::fmt;

/// Most bytes of a category's name.
const MAX_CATEGORY_BYTES: usize = 100;

/// Which view of which object: `<category>_<instance>_<sequence>_<frame>`. The
/// category may itself have underscores and numbers.
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
    /// Puts a name together. `None` when the category is empty, has other
    /// characters than letters, digits, `_` and `-`, or is longer than 100
    /// bytes: it is the name of a folder.
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

    /// Reads a name as it is displayed, from its end; `None` when it is none.
    pub fn parse(text: &str) -> Option<Self> {
        let mut parts = text.rsplitn(4, '_');
        let (frame, sequence) = (number(parts.next()?)?, number(parts.next()?)?);
        let (instance, category) = (number(parts.next()?)?, parts.next()?);
        Self::new(category, instance, sequence, frame)
    }

    /// Kind of object, such as `cell_phone`.
    pub fn category(&self) -> &str {
        &self.category
    }

    /// Which object of its kind, from 1 in the data set.
    pub fn instance(&self) -> u32 {
        self.instance
    }

    /// Which turn of the turntable; 1, 2 and 4 in the data set, each seen from
    /// another height.
    pub fn sequence(&self) -> u32 {
        self.sequence
    }

    /// Which frame of the turn, from 1 in the data set.
    pub fn frame(&self) -> u32 {
        self.frame
    }
}

/// A number as it is displayed: without sign and leading zeros, so that a name
/// leads back to its file.
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
        crate::natural_order(&self.category, &other.category)
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
    fn other_names_are_none() {
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
        fn what_is_parsed_is_displayed_the_same(text in "[a-c_]{0,3}_?[0-9]{0,2}_[0-9]{1,2}_[0-9]") {
            if let Some(name) = ViewName::parse(&text) {
                prop_assert_eq!(name.to_string(), text);
            }
        }
    }
}
