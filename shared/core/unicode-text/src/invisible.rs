//! Invisible characters: default-ignorable code points, controls and format characters.

use regex_syntax::hir::{Class, HirKind};
use std::sync::LazyLock;

/// Characters without an image of their own. The blank Braille pattern is a symbol by its
/// properties, and has no ink.
const INVISIBLE: &str = r"[\p{Default_Ignorable_Code_Point}\p{Cc}\p{Cf}\p{Zl}\p{Zp}\x{2800}]";

/// Letters and marks that a joiner can connect or separate: those of the cursive scripts, and of
/// the scripts whose consonants form conjuncts (UAX #31, section 2.3, rules A1, A2 and B).
const JOINING: &str = r"[[\p{Arabic}\p{Syriac}\p{Mandaic}\p{Mongolian}\p{Nko}\p{Phags_Pa}\p{Adlam}
    \p{Devanagari}\p{Bengali}\p{Gurmukhi}\p{Gujarati}\p{Oriya}\p{Tamil}\p{Telugu}\p{Kannada}
    \p{Malayalam}\p{Sinhala}\p{Khmer}\p{Myanmar}\p{Tibetan}\p{Balinese}\p{Javanese}]
    &&[\p{L}\p{M}]]";

static INVISIBLE_RANGES: LazyLock<Vec<(char, char)>> = LazyLock::new(|| ranges(INVISIBLE));
static JOINING_RANGES: LazyLock<Vec<(char, char)>> = LazyLock::new(|| ranges(JOINING));

/// Ranges of a character class in ascending order.
fn ranges(class: &str) -> Vec<(char, char)> {
    let mut parser = regex_syntax::ParserBuilder::new()
        .ignore_whitespace(true)
        .build();
    match parser.parse(class).map(regex_syntax::hir::Hir::into_kind) {
        Ok(HirKind::Class(Class::Unicode(class))) => {
            let ranges = class.ranges().iter();
            ranges.map(|range| (range.start(), range.end())).collect()
        }
        // The classes are constants, and tested.
        _ => Vec::new(),
    }
}

fn is_among(ranges: &[(char, char)], c: char) -> bool {
    let n_before = ranges.partition_point(|(_, last)| *last < c);
    ranges.get(n_before).is_some_and(|(first, _)| *first <= c)
}

/// True for a character that is not seen: a default-ignorable code point, a control or format
/// character, or a line separator.
pub fn is_invisible(c: char) -> bool {
    !is_plain_ascii(c) && is_among(&INVISIBLE_RANGES, c)
}

/// True for an invisible character that could rewrite a terminal or a log, or hide in a text.
///
/// Joiners and variation selectors are printable, since they shape the characters beside them.
pub fn is_unprintable(c: char) -> bool {
    let is_shaping =
        is_joiner(c) || matches!(c, '\u{fe00}'..='\u{fe0f}' | '\u{e0100}'..='\u{e01ef}');
    !is_shaping && is_invisible(c)
}

/// True for the zero-width joiner and non-joiner.
pub fn is_joiner(c: char) -> bool {
    matches!(c, '\u{200c}' | '\u{200d}')
}

/// First joiner that has no effect: it is not between letters of a script that has joined forms.
pub fn joiner_out_of_place(text: &str) -> Option<char> {
    let characters: Vec<char> = text.chars().collect();
    let is_joining = |position: Option<usize>| {
        let c = position.and_then(|position| characters.get(position));
        c.is_some_and(|c| is_among(&JOINING_RANGES, *c))
    };
    let joiners = characters
        .iter()
        .enumerate()
        .filter(|(_, c)| is_joiner(**c));
    let mut out_of_place = joiners.filter(|(position, _)| {
        !(is_joining(position.checked_sub(1)) && is_joining(Some(position + 1)))
    });
    out_of_place.next().map(|(_, c)| *c)
}

fn is_plain_ascii(c: char) -> bool {
    matches!(c, ' '..='~')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invisible_characters_are_those_of_unicode() {
        assert!(INVISIBLE_RANGES.len() > 20 && JOINING_RANGES.len() > 50);
        // Controls, marks of direction, fillers, tags, selectors, a shy hyphen, a blank pattern.
        let invisible = "\0\n\u{7f}\u{85}\u{ad}\u{34f}\u{61c}\u{115f}\u{1160}\u{17b4}\u{180e}\
                         \u{200b}\u{200d}\u{2028}\u{202e}\u{2066}\u{2800}\u{3164}\u{fe0f}\u{feff}\
                         \u{ffa0}\u{fff9}\u{1d173}\u{e0001}\u{e0041}\u{e01ef}\u{e0fff}";
        for c in invisible.chars() {
            assert!(is_invisible(c), "U+{:04X}", u32::from(c));
        }
        for c in "aé ßш杯☕𝄞ｶ\u{301}\u{a0}\u{3000}".chars() {
            assert!(!is_invisible(c), "U+{:04X}", u32::from(c));
        }
        // The short way gives the same answer.
        assert!((' '..='~').all(|c| !is_among(&INVISIBLE_RANGES, c)));
    }

    #[test]
    fn unprintable_characters_leave_the_shapes_of_all_scripts() {
        assert!("می‌خواهم ☕\u{fe0f}".chars().all(|c| !is_unprintable(c)));
        assert!(
            "\u{1b}\u{9b}\u{202e}\u{3164}\u{e0041}"
                .chars()
                .all(is_unprintable)
        );
    }

    #[test]
    fn joiner_is_in_place_where_it_shapes_letters() {
        for text in ["می‌خواهم", "क्‍ष", "mug"] {
            assert_eq!(joiner_out_of_place(text), None, "{text}");
        }
        for text in [
            "m\u{200c}ug",
            "mug\u{200d}",
            "\u{200d}",
            "می\u{200c}",
            "☕\u{200d}☕",
        ] {
            assert!(joiner_out_of_place(text).is_some(), "{text}");
        }
    }
}
