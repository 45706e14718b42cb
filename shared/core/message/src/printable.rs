//! Printable text: control and invisible characters, which could rewrite a terminal or a log.

use std::borrow::Cow;
use std::fmt::Write;

/// True for control characters, line separators, direction marks and overrides, and zero-width
/// characters other than the joiners that some scripts need.
pub fn is_unprintable(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}'
            | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// Text with its unprintable characters as `\u{1b}`.
pub fn escape_unprintable(text: &str) -> Cow<'_, str> {
    escape_where(text, is_unprintable)
}

/// Text of several lines, with its other unprintable characters as `\u{1b}`.
pub fn escape_unprintable_lines(text: &str) -> Cow<'_, str> {
    escape_where(text, |c| c != '\n' && is_unprintable(c))
}

fn escape_where(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_escaped(c) {
            // Writing to a string never fails.
            let _ = write!(escaped, "\\u{{{:x}}}", u32::from(c));
        } else {
            escaped.push(c);
        }
    }
    Cow::Owned(escaped)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escape_leaves_printable_text_of_any_script() {
        for text in ["coffee mug", "Tasse für Ben", "杯子", "می‌خواهم"] {
            assert!(matches!(escape_unprintable(text), Cow::Borrowed(same) if same == text));
        }
    }

    #[test]
    fn escape_disarms_terminal_sequences_and_forged_lines() {
        let hostile = "anna\u{1b}[2J\u{9b}2J\u{7}\n99 ben\u{202e}\r";
        let escaped = escape_unprintable(hostile);
        assert!(!escaped.chars().any(is_unprintable), "{escaped}");
        assert!(escaped.starts_with("anna\\u{1b}[2J\\u{9b}2J\\u{7}\\u{a}99"));
        let lines = escape_unprintable_lines(hostile);
        assert_eq!(lines.lines().count(), 2);
    }
}
