//! The numbers behind the header of a PLY file, one after the other.

use super::header::{Element, Kind};
use crate::number::{ByteOrder, NumberType, excerpt};

/// Why the next number is not there.
#[derive(Debug)]
pub(super) enum Missing {
    /// The file ends.
    End,
    /// There is something else.
    Wrong(String),
}

/// Where numbers come from.
pub(super) trait Values {
    /// Whether the rest of the file may hold all rows of the element. Each row
    /// takes at least one byte, so a row without properties is never one.
    fn may_hold(&self, element: &Element<'_>) -> bool;
    /// Goes to the start of a row.
    fn begin_row(&mut self) -> Result<(), Missing>;
    /// The next number of a row.
    fn next(&mut self, number: NumberType) -> Result<f64, Missing>;
    /// Checks that a row is over.
    fn end_row(&mut self) -> Result<(), Missing>;
    /// Whether nothing is left.
    fn at_end(&self) -> bool;
}

/// Numbers as bytes.
pub(super) struct BinaryValues<'a> {
    pub(super) rest: &'a [u8],
    pub(super) order: ByteOrder,
}

impl Values for BinaryValues<'_> {
    fn may_hold(&self, element: &Element<'_>) -> bool {
        let row_bytes = element
            .properties
            .iter()
            .map(|property| match property.kind {
                Kind::Number(number) => number.size(),
                Kind::List { count, .. } => count.size(),
            });
        let needed = row_bytes.sum::<usize>().checked_mul(element.n_rows);
        needed.is_some_and(|needed| needed <= self.rest.len())
    }

    fn begin_row(&mut self) -> Result<(), Missing> {
        Ok(())
    }

    #[inline]
    fn next(&mut self, number: NumberType) -> Result<f64, Missing> {
        let value = number.read(self.rest, self.order).ok_or(Missing::End)?;
        self.rest = &self.rest[number.size()..];
        Ok(value)
    }

    fn end_row(&mut self) -> Result<(), Missing> {
        Ok(())
    }

    fn at_end(&self) -> bool {
        self.rest.is_empty()
    }
}

/// Numbers as text, a line for each row; blank lines are skipped.
pub(super) struct TextValues<'a> {
    pub(super) rest: &'a str,
    pub(super) line: std::str::SplitAsciiWhitespace<'a>,
}

impl<'a> TextValues<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self {
            rest: text,
            line: "".split_ascii_whitespace(),
        }
    }
}

impl Values for TextValues<'_> {
    fn may_hold(&self, element: &Element<'_>) -> bool {
        // A digit and a separator for each number; the last needs none.
        let needed = (2 * element.properties.len()).checked_mul(element.n_rows);
        needed.is_some_and(|needed| needed <= self.rest.len() + 1)
    }

    fn begin_row(&mut self) -> Result<(), Missing> {
        self.rest = self.rest.trim_ascii_start();
        if self.rest.is_empty() {
            return Err(Missing::End);
        }
        let (line, rest) = self.rest.split_once('\n').unwrap_or((self.rest, ""));
        (self.line, self.rest) = (line.split_ascii_whitespace(), rest);
        Ok(())
    }

    fn next(&mut self, number: NumberType) -> Result<f64, Missing> {
        let word = self
            .line
            .next()
            .ok_or(Missing::Wrong("a number is missing".to_owned()))?;
        number.parse(word).ok_or_else(|| {
            Missing::Wrong(format!(
                "\"{}\" is not a number of the announced type",
                excerpt(word)
            ))
        })
    }

    fn end_row(&mut self) -> Result<(), Missing> {
        match self.line.next() {
            None => Ok(()),
            Some(_) => Err(Missing::Wrong("there are too many numbers".to_owned())),
        }
    }

    fn at_end(&self) -> bool {
        self.rest.trim_ascii_start().is_empty()
    }
}
