//! What a child tells when it has done its part: a line for each series of
//! nanoseconds or counts, and a last line, so that a cut answer is noticed.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};

const END: &str = "end";

#[derive(Debug, Default, PartialEq)]
pub struct Answer {
    lines: BTreeMap<String, Vec<u64>>,
}

/// Why an answer can not be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BadAnswer {
    /// The child ended before its last line.
    Cut,
    /// Not a name and numbers.
    Line(String),
    /// There is no such line, or it does not have the numbers it should.
    Missing(&'static str),
}

impl fmt::Display for BadAnswer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cut => f.write_str("a child ended before its answer did"),
            Self::Line(line) => write!(f, "a child said {line:?}, which is no line of figures"),
            Self::Missing(name) => write!(f, "a child did not say its {name}"),
        }
    }
}

impl std::error::Error for BadAnswer {}

impl Answer {
    pub fn with(mut self, name: &str, numbers: impl Into<Vec<u64>>) -> Self {
        self.lines.insert(name.to_owned(), numbers.into());
        self
    }

    pub fn parse(text: &str) -> Result<Self, BadAnswer> {
        let body = text
            .strip_suffix(&format!("{END}\n"))
            .ok_or(BadAnswer::Cut)?;
        let lines = body.lines().map(|line| {
            let (name, numbers) = line.split_once(' ').unwrap_or((line, ""));
            let numbers = numbers.split_ascii_whitespace().map(str::parse);
            match numbers.collect() {
                Ok(numbers) if !name.is_empty() => Ok((name.to_owned(), numbers)),
                _ => Err(BadAnswer::Line(line.to_owned())),
            }
        });
        let lines = lines.collect::<Result<_, _>>()?;
        Ok(Self { lines })
    }

    /// Numbers of a line, at least one.
    pub fn series(&self, name: &'static str) -> Result<&[u64], BadAnswer> {
        let series = self.lines.get(name).filter(|series| !series.is_empty());
        series.map(Vec::as_slice).ok_or(BadAnswer::Missing(name))
    }

    /// The only number of a line.
    pub fn figure(&self, name: &'static str) -> Result<u64, BadAnswer> {
        match self.series(name)? {
            &[figure] => Ok(figure),
            _ => Err(BadAnswer::Missing(name)),
        }
    }
}

impl fmt::Display for Answer {
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
    fn an_answer_is_read_as_it_was_said() {
        let answer = Answer::default()
            .with("lost", [3])
            .with("latency_ns", [1, u64::MAX])
            .with("none", []);
        let read = Answer::parse(&answer.to_string()).unwrap();
        assert_eq!(read, answer);
        assert_eq!(read.figure("lost"), Ok(3));
        assert_eq!(read.series("latency_ns"), Ok(&[1, u64::MAX][..]));
    }

    #[test]
    fn a_cut_answer_is_refused_wherever_it_ends() {
        let text = Answer::default().with("latency_ns", [1, 20]).to_string();
        for n_bytes in 0..text.len() {
            assert_eq!(Answer::parse(&text[..n_bytes]), Err(BadAnswer::Cut));
        }
    }

    #[test]
    fn what_is_no_figure_is_refused() {
        for line in [
            "latency_ns 1 x",
            "latency_ns -1",
            "latency_ns 1.5",
            " 1",
            "",
        ] {
            let expected = Err(BadAnswer::Line(line.to_owned()));
            assert_eq!(Answer::parse(&format!("{line}\nend\n")), expected);
        }
    }

    #[test]
    fn a_missing_line_is_named() {
        let answer = Answer::parse("lost 1 2\nnone\nend\n").unwrap();
        assert_eq!(answer.series("cpu_ns"), Err(BadAnswer::Missing("cpu_ns")));
        assert_eq!(answer.series("none"), Err(BadAnswer::Missing("none")));
        assert_eq!(answer.figure("lost"), Err(BadAnswer::Missing("lost")));
    }
}
