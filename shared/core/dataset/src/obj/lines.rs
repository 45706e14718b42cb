//! Tokeniser of OBJ files and material libraries.

use crate::ModelError;
use file_access::excerpt;

/// Line that is neither blank nor a comment, joined with its continuation lines.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    /// Line number in the OBJ file, from 1.
    pub(super) number: usize,
    /// First word of the line: its keyword.
    pub(super) keyword: &'a [u8],
    /// Text of the line after the keyword.
    rest: &'a [u8],
}

impl<'a> Line<'a> {
    /// Text after the keyword. Skipped lines may be in any encoding, so only this method decodes
    /// UTF-8.
    pub(super) fn text(&self) -> Result<&'a str, ModelError> {
        let text = std::str::from_utf8(self.rest);
        text.map(str::trim_ascii)
            .map_err(|_| self.error("it is not UTF-8 text".to_owned()))
    }

    /// Words after the keyword. A backslash continues a line.
    pub(super) fn words(&self) -> Result<impl Iterator<Item = &'a str> + use<'a>, ModelError> {
        let is_space = |character: char| character.is_ascii_whitespace() || character == '\\';
        let words = self.text()?.split(is_space);
        Ok(words.filter(|word| !word.is_empty()))
    }

    /// Parses the numbers after the keyword into a slice and returns their count.
    pub(super) fn numbers(&self, numbers: &mut [f32]) -> Result<usize, ModelError> {
        let mut n_read = 0;
        for word in self.words()? {
            let Some(number) = numbers.get_mut(n_read) else {
                return Err(self.error("there are too many numbers".to_owned()));
            };
            *number = match word.parse() {
                Ok(value) if f32::is_finite(value) => value,
                _ => {
                    return Err(self.error(format!("\"{}\" is not a finite number", excerpt(word))));
                }
            };
            n_read += 1;
        }
        Ok(n_read)
    }

    pub(super) fn error(&self, problem: String) -> ModelError {
        ModelError::Line {
            format: "OBJ",
            line: self.number,
            problem,
        }
    }
}

/// Splits an OBJ file into its lines.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let (mut rest, mut n_lines) = (bytes, 0);
    std::iter::from_fn(move || {
        while !rest.is_empty() {
            let number = n_lines + 1;
            let (line, behind, n_joined) = split_line(rest);
            (rest, n_lines) = (behind, n_lines + n_joined);
            let line = line.trim_ascii();
            if line.is_empty() || line.starts_with(b"#") {
                continue;
            }
            let end = line.iter().position(u8::is_ascii_whitespace);
            let (keyword, rest) = line.split_at(end.unwrap_or(line.len()));
            return Some(Line {
                number,
                keyword,
                rest,
            });
        }
        None
    })
}

/// Splits off a line, and counts the lines joined by backslashes. A comment is never continued.
fn split_line(bytes: &[u8]) -> (&[u8], &[u8], usize) {
    let is_comment = bytes.trim_ascii_start().starts_with(b"#");
    let (mut end, mut n_joined) = (0, 0);
    loop {
        n_joined += 1;
        let Some(length) = bytes[end..].iter().position(|&byte| byte == b'\n') else {
            return (bytes, &[], n_joined);
        };
        end += length + 1;
        let line = &bytes[..end - 1];
        let is_continued = line.strip_suffix(b"\r").unwrap_or(line).ends_with(b"\\");
        if is_comment || !is_continued {
            return (line, &bytes[end..], n_joined);
        }
    }
}
