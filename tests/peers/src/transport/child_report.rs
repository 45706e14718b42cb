//! Text protocol of the child processes: named series of nanoseconds or counts, one per line.
//!
//! A last line marks the end, so that a truncated report is detected.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};

/// Last line of a report.
const END: &str = "end";

/// Measurements of a child process: series of numbers by name.
#[derive(Debug, Default, PartialEq)]
pub struct ChildReport {
    lines: BTreeMap<String, Vec<u64>>,
}

/// Error in the report of a child process.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ReportError {
    /// Truncated report: the last line is missing.
    Truncated,
    /// Malformed line: not a name and unsigned integers.
    Line(String),
    /// Missing series, or one with a wrong number of values.
    Missing(&'static str),
}

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated => f.write_str("the report of a child process is truncated"),
            Self::Line(line) => write!(
                f,
                "the report of a child process has a malformed line {line:?}"
            ),
            Self::Missing(name) => write!(f, "the report of a child process has no valid {name}"),
        }
    }
}

impl std::error::Error for ReportError {}

impl ChildReport {
    /// Adds a series.
    pub fn with(mut self, name: &str, numbers: impl Into<Vec<u64>>) -> Self {
        self.lines.insert(name.to_owned(), numbers.into());
        self
    }

    /// Parses a whole report.
    ///
    /// # Errors
    /// If the report is truncated or a line is malformed.
    pub fn parse(text: &str) -> Result<Self, ReportError> {
        let body = text
            .strip_suffix(&format!("{END}\n"))
            .ok_or(ReportError::Truncated)?;
        let lines = body.lines().map(|line| {
            let (name, numbers) = line.split_once(' ').unwrap_or((line, ""));
            let numbers = numbers.split_ascii_whitespace().map(str::parse);
            match numbers.collect() {
                Ok(numbers) if !name.is_empty() => Ok((name.to_owned(), numbers)),
                _ => Err(ReportError::Line(line.to_owned())),
            }
        });
        let lines = lines.collect::<Result<_, _>>()?;
        Ok(Self { lines })
    }

    /// Series of a name, not empty.
    ///
    /// # Errors
    /// [`ReportError::Missing`].
    pub fn series(&self, name: &'static str) -> Result<&[u64], ReportError> {
        let series = self.lines.get(name).filter(|series| !series.is_empty());
        series.map(Vec::as_slice).ok_or(ReportError::Missing(name))
    }

    /// Scalar of a name: a series with exactly one value.
    ///
    /// # Errors
    /// [`ReportError::Missing`].
    pub fn figure(&self, name: &'static str) -> Result<u64, ReportError> {
        match self.series(name)? {
            &[figure] => Ok(figure),
            _ => Err(ReportError::Missing(name)),
        }
    }
}

impl fmt::Display for ChildReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = String::new();
        for (name, numbers) in &self.lines {
            text.push_str(name);
            for number in numbers {
                write!(text, " {number}")?;
            }
            text.push('\n');
        }
        writeln!(f, "{text}{END}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_trip_preserves_the_report() {
        let report = ChildReport::default()
            .with("lost", [3])
            .with("latency_ns", [1, u64::MAX])
            .with("none", []);
        let read = ChildReport::parse(&report.to_string()).unwrap();
        assert_eq!(read, report);
        assert_eq!(read.figure("lost"), Ok(3));
        assert_eq!(read.series("latency_ns"), Ok(&[1, u64::MAX][..]));
    }

    #[test]
    fn truncated_report_is_rejected_at_every_length() {
        let text = ChildReport::default()
            .with("latency_ns", [1, 20])
            .to_string();
        for n_bytes in 0..text.len() {
            assert_eq!(
                ChildReport::parse(&text[..n_bytes]),
                Err(ReportError::Truncated)
            );
        }
    }

    #[test]
    fn malformed_line_is_rejected() {
        for line in [
            "latency_ns 1 x",
            "latency_ns -1",
            "latency_ns 1.5",
            " 1",
            "",
        ] {
            let expected = Err(ReportError::Line(line.to_owned()));
            assert_eq!(ChildReport::parse(&format!("{line}\nend\n")), expected);
        }
    }

    #[test]
    fn missing_series_is_named_in_the_error() {
        let report = ChildReport::parse("lost 1 2\nnone\nend\n").unwrap();
        assert_eq!(report.series("cpu_ns"), Err(ReportError::Missing("cpu_ns")));
        assert_eq!(report.series("none"), Err(ReportError::Missing("none")));
        assert_eq!(report.figure("lost"), Err(ReportError::Missing("lost")));
    }
}
