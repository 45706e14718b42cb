//! Printable text: escapes of control and invisible characters, which could rewrite a terminal or a
//! log, or hide in it.

use std::borrow::Cow;
use std::fmt::Write;

use crate::is_unprintable;

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
        assert_eq!(escape_unprintable("mug\u{3164}"), "mug\\u{3164}");
        let lines = escape_unprintable_lines(hostile);
        assert_eq!(lines.lines().count(), 2);
    }
}
