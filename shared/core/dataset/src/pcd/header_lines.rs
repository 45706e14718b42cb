//! Tokeniser of the header of a PCD file.

use super::encoding::Encoding;
use super::error::Error;
use file_access::excerpt;

/// Limit of the search for the end of the header, bytes.
const MAX_HEADER_BYTES: usize = 1 << 16;

const KEYS: [&str; 9] = [
    "VERSION",
    "FIELDS",
    "SIZE",
    "TYPE",
    "COUNT",
    "WIDTH",
    "HEIGHT",
    "VIEWPOINT",
    "POINTS",
];

/// Line of the header: number, keyword and words.
pub(super) struct Line<'a> {
    number: usize,
    key: &'static str,
    pub(super) words: Vec<&'a str>,
}

impl Line<'_> {
    pub(super) fn error(&self, problem: &str) -> Error {
        let problem = format!("\"{} …\": {problem}", self.key);
        Error::HeaderLine {
            line: self.number,
            problem,
        }
    }

    pub(super) fn one_of(&self, allowed: &[&str]) -> Result<(), Error> {
        match self.words[..] {
            [word] if allowed.contains(&word) => Ok(()),
            _ => Err(self.error(&format!("it must be {}", allowed.join(" or ")))),
        }
    }

    /// Only word of the line as a number.
    pub(super) fn count(&self) -> Result<usize, Error> {
        if self.words.len() == 1 {
            self.number(0)
        } else {
            Err(self.error("it must be a number"))
        }
    }

    /// Word at `idx`, which must be valid, as a number.
    pub(super) fn number(&self, idx: usize) -> Result<usize, Error> {
        let word = self.words[idx];
        word.parse()
            .map_err(|_| self.error(&format!("\"{}\" is not a count", excerpt(word))))
    }
}

/// Lines of the PCD header before its `DATA` line.
pub(super) struct Lines<'a>(Vec<Line<'a>>);

impl<'a> Lines<'a> {
    /// Splits the header; returns the lines, the encoding and the offset of the data.
    pub(super) fn split(bytes: &'a [u8]) -> Result<(Self, Encoding, usize), Error> {
        let mut lines = Vec::new();
        let mut rest = &bytes[..bytes.len().min(MAX_HEADER_BYTES)];
        let mut number = 0;
        loop {
            number += 1;
            let end = rest
                .iter()
                .position(|&byte| byte == b'\n')
                .ok_or(Error::NoData)?;
            let (line, after) = (&rest[..end], &rest[end + 1..]);
            let text = std::str::from_utf8(line).map_err(|_| Error::NoData)?;
            let data_offset = bytes.len().min(MAX_HEADER_BYTES) - after.len();
            rest = after;
            let mut words = text.split_ascii_whitespace();
            match words.next() {
                None => {}
                Some(word) if word.starts_with('#') => {}
                Some("DATA") => return Ok((Self(lines), encoding(words, number)?, data_offset)),
                Some(key) => push_line(&mut lines, number, key, words.collect())?,
            }
        }
    }

    pub(super) fn find(&self, key: &str) -> Option<&Line<'a>> {
        self.0.iter().find(|line| line.key == key)
    }

    pub(super) fn require(&self, key: &'static str) -> Result<&Line<'a>, Error> {
        self.find(key).ok_or(Error::MissingLine(key))
    }
}

fn encoding<'a>(words: impl Iterator<Item = &'a str>, line: usize) -> Result<Encoding, Error> {
    match words.collect::<Vec<_>>()[..] {
        ["ascii"] => Ok(Encoding::Ascii),
        ["binary"] => Ok(Encoding::Binary),
        ["binary_compressed"] => Ok(Encoding::BinaryCompressed),
        _ => {
            let problem = "DATA must be ascii, binary or binary_compressed".to_owned();
            Err(Error::HeaderLine { line, problem })
        }
    }
}

fn push_line<'a>(
    lines: &mut Vec<Line<'a>>,
    number: usize,
    key: &str,
    words: Vec<&'a str>,
) -> Result<(), Error> {
    let Some(&key) = KEYS.iter().find(|known| **known == key) else {
        let problem = format!("\"{}\" is no word of a PCD header", excerpt(key));
        return Err(Error::HeaderLine {
            line: number,
            problem,
        });
    };
    let line = Line { number, key, words };
    if lines.iter().any(|earlier| earlier.key == key) {
        return Err(line.error("it is there twice"));
    }
    lines.push(line);
    Ok(())
}
