//! Normal form, invisible characters and look-alikes of text that people write, by the tables of
//! Unicode.
//!
//! The only place of these rules: names of categories, texts of requests, and all that is printed
//! follow them. It never changes a text without being asked to.

mod invisible;
mod likeness;
mod printable;

pub use invisible::{is_invisible, is_joiner, is_unprintable, joiner_out_of_place};
pub use likeness::{Likeness, likeness};
pub use printable::{escape_unprintable, escape_unprintable_lines};

use unicode_normalization::UnicodeNormalization;

/// Text in normalization form C (UAX #15), in which equal texts have equal bytes.
pub fn nfc(text: &str) -> String {
    text.nfc().collect()
}
