//! Sequential reader of the numbers after the header of a PLY file.

use crate::header::{Element, PropertyKind};
use file_access::{ByteOrder, NumberType, excerpt};

/// Error of reading the next number of a PLY file.
#[derive(Debug)]
pub(super) enum ValueError {
    /// File that ends before the expected number.
    EndOfFile,
    /// Invalid number or value; the reason as a clause.
    Wrong(String),
}

/// Sequential reader of numbers, row by row.
pub(super) trait ValueReader {
    /// True if the rest of the file can hold all rows of the element. Each row takes at least one
    /// byte, so rows without properties must not be counted.
    fn can_hold_rows(&self, element: &Element<'_>) -> bool;
    /// Starts reading a row.
    fn begin_row(&mut self) -> Result<(), ValueError>;
    /// Reads the next number of a row.
    fn next(&mut self, number: NumberType) -> Result<f64, ValueError>;
    /// Checks that the row has been read completely.
    fn end_row(&mut self) -> Result<(), ValueError>;
    /// True if no unread data is left.
    fn at_end(&self) -> bool;
}

/// Reader of binary numbers.
pub(super) struct BinaryValueReader<'a> {
    pub(super) rest: &'a [u8],
    pub(super) order: ByteOrder,
}

impl ValueReader for BinaryValueReader<'_> {
    fn can_hold_rows(&self, element: &Element<'_>) -> bool {
        let row_bytes = element
            .properties
            .iter()
            .map(|property| match property.kind {
                PropertyKind::Number(number) => number.size(),
                PropertyKind::List { count, .. } => count.size(),
            });
        let needed = row_bytes.sum::<usize>().checked_mul(element.n_rows);
        needed.is_some_and(|needed| needed <= self.rest.len())
    }

    fn begin_row(&mut self) -> Result<(), ValueError> {
        Ok(())
    }

    #[inline]
    fn next(&mut self, number: NumberType) -> Result<f64, ValueError> {
        let value = number
            .read(self.rest, self.order)
            .ok_or(ValueError::EndOfFile)?;
        self.rest = &self.rest[number.size()..];
        Ok(value)
    }

    fn end_row(&mut self) -> Result<(), ValueError> {
        Ok(())
    }

    fn at_end(&self) -> bool {
        self.rest.is_empty()
    }
}

/// Reader of numbers in text, one line for each row; blank lines are skipped.
pub(super) struct TextValueReader<'a> {
    pub(super) rest: &'a str,
    pub(super) line: std::str::SplitAsciiWhitespace<'a>,
}

impl<'a> TextValueReader<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self {
            rest: text,
            line: "".split_ascii_whitespace(),
        }
    }
}

impl ValueReader for TextValueReader<'_> {
    fn can_hold_rows(&self, element: &Element<'_>) -> bool {
        // A digit and a separator for each number; the last needs none.
        let needed = (2 * element.properties.len()).checked_mul(element.n_rows);
        needed.is_some_and(|needed| needed <= self.rest.len() + 1)
    }

    fn begin_row(&mut self) -> Result<(), ValueError> {
        self.rest = self.rest.trim_ascii_start();
        if self.rest.is_empty() {
            return Err(ValueError::EndOfFile);
        }
        let (line, rest) = self.rest.split_once('\n').unwrap_or((self.rest, ""));
        (self.line, self.rest) = (line.split_ascii_whitespace(), rest);
        Ok(())
    }

    fn next(&mut self, number: NumberType) -> Result<f64, ValueError> {
        let word = self
            .line
            .next()
            .ok_or(ValueError::Wrong("a number is missing".to_owned()))?;
        number.parse(word).ok_or_else(|| {
            ValueError::Wrong(format!(
                "\"{}\" is not a number of the announced type",
                excerpt(word)
            ))
        })
    }

    fn end_row(&mut self) -> Result<(), ValueError> {
        match self.line.next() {
            None => Ok(()),
            Some(_) => Err(ValueError::Wrong("there are too many numbers".to_owned())),
        }
    }

    fn at_end(&self) -> bool {
        self.rest.trim_ascii_start().is_empty()
    }
}
