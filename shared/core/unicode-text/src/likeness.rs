//! Likeness of texts: confusable skeletons (UTS #39) and folded case.

use crate::nfc;
use unicode_security::skeleton;

/// Degree of likeness of two different texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Likeness {
    /// Same text in another normal form.
    SameText,
    /// Same text but for upper and lower case.
    SameLetters,
    /// Texts that look alike.
    SameLook,
}

/// Likeness of two texts; `None` if nobody takes one for the other.
pub fn likeness(a: &str, b: &str) -> Option<Likeness> {
    if nfc(a) == nfc(b) {
        Some(Likeness::SameText)
    } else if folded(a) == folded(b) {
        Some(Likeness::SameLetters)
    } else if skeleton(a).eq(skeleton(b)) || skeleton(&folded(a)).eq(skeleton(&folded(b))) {
        Some(Likeness::SameLook)
    } else {
        None
    }
}

/// Text in folded case, by its upper case, so that "ß" equals "SS".
fn folded(text: &str) -> String {
    nfc(&nfc(text).to_uppercase().to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn likeness_is_that_of_form_case_and_look() {
        use Likeness::{SameLetters, SameLook, SameText};
        for (a, b, expected) in [
            ("caf\u{e9}", "cafe\u{301}", Some(SameText)),
            ("bottle", "Bottle", Some(SameLetters)),
            ("Straße", "STRASSE", Some(SameLetters)),
            ("cup", "сup", Some(SameLook)),
            ("CUP", "сup", Some(SameLook)),
            ("bowl 1", "bowl l", Some(SameLook)),
            ("mug", "mug\u{3164}", Some(SameLook)),
            ("mug", "mugs", None),
            ("bowl 1", "bowl 2", None),
            ("café", "cafe", None),
        ] {
            assert_eq!(likeness(a, b), expected, "{a} {b}");
            assert_eq!(likeness(b, a), expected, "{b} {a}");
        }
    }

    proptest! {
        #[test]
        fn normal_form_is_idempotent_and_the_same_text(text in any::<String>()) {
            let normal = nfc(&text);
            prop_assert_eq!(nfc(&normal), normal.clone());
            prop_assert_eq!(likeness(&text, &normal), Some(Likeness::SameText));
        }

        #[test]
        fn likeness_is_symmetric(a in "[aAbс1lI ]{1,4}", b in "[aAbс1lI ]{1,4}") {
            prop_assert_eq!(likeness(&a, &b), likeness(&b, &a));
        }
    }
}
