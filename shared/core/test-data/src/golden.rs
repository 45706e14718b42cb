//! Golden files: bytes of stored and sent records, pinned in the repository.
//!
//! A golden file has a line for each example, `name = bytes`, with the bytes as Rust escapes them
//! in a byte string, so that names of fields can be read in a review; lines that begin with `#` are
//! remarks. No test writes these files. A record that gets another form gets another file beside
//! the old one, whose lines are still decoded.

#![expect(clippy::panic, reason = "helpers of tests fail as tests do")]

use std::fmt::{Debug, Write};
use std::path::Path;
use std::{fs, iter};

/// Examples of a golden file: name and bytes of each.
///
/// # Panics
/// When the file cannot be read or a line is malformed.
pub fn read(file: &Path) -> Vec<(String, Vec<u8>)> {
    let text = fs::read_to_string(file)
        .unwrap_or_else(|error| panic!("the golden file {}: {error}", file.display()));
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let example = |line: &str| {
        let (name, bytes) = line.split_once(" = ")?;
        Some((name.to_owned(), unescaped(bytes)?))
    };
    lines
        .map(|line| example(line).unwrap_or_else(|| panic!("no example of a golden file: {line}")))
        .collect()
}

/// Checks that examples have the bytes of a golden file, and that these bytes are decoded to the
/// examples.
///
/// # Panics
/// When an example has other bytes, decodes to another value, or is missing on either side, with
/// the lines as they would be today.
pub fn check<T: Debug + PartialEq>(
    file: &Path,
    examples: &[(&str, T)],
    encode: impl Fn(&T) -> Vec<u8>,
    decode: impl Fn(&[u8]) -> T,
) {
    let pinned = if file.exists() {
        read(file)
    } else {
        Vec::new()
    };
    let mut wrong = String::new();
    for (name, value) in examples {
        let bytes = encode(value);
        let known = pinned.iter().find(|(pinned, _)| pinned == name);
        if known.is_none_or(|(_, pinned)| *pinned != bytes) {
            let _ = writeln!(wrong, "{name} = {}", escaped(&bytes));
        }
    }
    assert!(
        wrong.is_empty(),
        "these examples do not have the bytes that {} pins; a stored or sent form never changes: \
         add a field with a default, or pin a new form in a file beside this one\n{wrong}",
        file.display()
    );
    for (name, bytes) in &pinned {
        let example = examples.iter().find(|(example, _)| example == name);
        let Some((_, value)) = example else {
            panic!("{}: no example is called {name:?}", file.display());
        };
        assert_eq!(decode(bytes), *value, "{}: {name}", file.display());
    }
}

/// Bytes as in a byte string of Rust, but with plain quotation marks.
fn escaped(bytes: &[u8]) -> String {
    let escaped = bytes.escape_ascii().to_string();
    escaped.replace("\\\"", "\"").replace("\\'", "'")
}

/// Bytes of [`escaped`].
fn unescaped(text: &str) -> Option<Vec<u8>> {
    let mut rest = text.bytes();
    let byte = |first: u8, rest: &mut std::str::Bytes<'_>| {
        if first != b'\\' {
            return Some(first);
        }
        match rest.next()? {
            b'n' => Some(b'\n'),
            b'r' => Some(b'\r'),
            b't' => Some(b'\t'),
            b'x' => {
                let digits = [rest.next()?, rest.next()?];
                u8::from_str_radix(str::from_utf8(&digits).ok()?, 16).ok()
            }
            other => Some(other),
        }
    };
    iter::from_fn(|| rest.next().map(|first| byte(first, &mut rest))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_a_golden_file_are_those_that_were_escaped() {
        let all: Vec<u8> = (0..=255).collect();
        assert_eq!(unescaped(&escaped(&all)), Some(all));
        assert_eq!(unescaped("\\x4"), None);
    }
}
