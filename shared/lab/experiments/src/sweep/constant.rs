//! Number constants in a source file, and their definitions scaled by a factor.

use service::Failure;
use std::path::{Path, PathBuf};

/// Number constant, or number field of a `Default` implementation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Constant {
    /// Source file of the constant, relative to the workspace.
    pub(super) file: PathBuf,
    /// Name of the constant or field.
    pub(super) name: String,
    /// Defining expression of the constant as written.
    pub(super) expression: String,
    /// True for a floating-point constant.
    is_float: bool,
    /// Byte range of the expression in the file.
    at: std::ops::Range<usize>,
    /// Source text of the file.
    text: String,
}

const FLOATS: [&str; 2] = ["f32", "f64"];
const INTEGERS: [&str; 10] = [
    "u8", "u16", "u32", "u64", "usize", "i8", "i16", "i32", "i64", "isize",
];

/// All number constants of a file: `const NAME: f64 = …;` outside tests, and the literal fields of
/// `impl Default` blocks.
pub(super) fn all(file: &Path, text: &str) -> Vec<Constant> {
    let end = text.find("#[cfg(test)]").unwrap_or(text.len());
    let mut found = Vec::new();
    let mut in_default = false;
    let mut offset = 0;
    for line in text[..end].split_inclusive('\n') {
        let trimmed = line.trim();
        if line.starts_with("impl") {
            in_default = line.contains("Default for");
        }
        let parsed = match constant_head(trimmed) {
            Some((name, kind)) => typed(kind).and_then(|is_float| {
                let begin = offset + line.find('=')? + 1;
                let length = text[begin..end].find(';')?;
                Some((name, is_float, begin..begin + length))
            }),
            None if in_default => literal_field(trimmed).map(|(name, value)| {
                let begin = offset + line.find(value).unwrap_or(0);
                (name, value.contains('.'), begin..begin + value.len())
            }),
            None => None,
        };
        if let Some((name, is_float, range)) = parsed {
            found.push(Constant {
                file: file.to_owned(),
                name: name.to_owned(),
                expression: text[range.clone()].trim().to_owned(),
                is_float,
                at: range,
                text: text.to_owned(),
            });
        }
        offset += line.len();
    }
    found
}

/// Name and type of `pub(crate) const NAME: TYPE = …`.
fn constant_head(line: &str) -> Option<(&str, &str)> {
    let (before, rest) = line.split_once("const ")?;
    let is_plain = before.is_empty() || before.starts_with("pub");
    let (name, rest) = rest.split_once(':')?;
    let (kind, _) = rest.split_once('=')?;
    (is_plain && !name.contains(' ')).then_some((name, kind.trim()))
}

/// True for a floating-point type; `None` for types that are no numbers.
fn typed(kind: &str) -> Option<bool> {
    if FLOATS.contains(&kind) {
        Some(true)
    } else {
        INTEGERS.contains(&kind).then_some(false)
    }
}

/// Name and value of a struct field such as `name: 0.02,`.
fn literal_field(line: &str) -> Option<(&str, &str)> {
    let (name, value) = line.strip_suffix(',')?.split_once(": ")?;
    let is_name = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let is_number = value.starts_with(|c: char| c.is_ascii_digit() || c == '-')
        && value
            .chars()
            .all(|c| c.is_ascii_digit() || "._-".contains(c));
    (is_name && is_number).then_some((name, value))
}

impl Constant {
    /// Content of the file with the constant scaled; integers are rounded.
    ///
    /// # Errors
    /// When the factor is no positive number.
    pub(super) fn scaled(&self, factor: f64) -> Result<String, Failure> {
        if !(factor.is_finite() && factor > 0.0) {
            return Err(Failure::general(format!("{factor} is no positive factor")));
        }
        let defined = &self.text[self.at.clone()];
        let expression = defined.trim();
        let begin = self.at.start + defined.len() - defined.trim_start().len();
        let scaled = if self.is_float {
            format!("({expression}) * {factor:?}")
        } else {
            // Exact for the usual factors, and constant at compile time.
            let (numerator, denominator) = ratio(factor);
            format!("({expression}) * {numerator} / {denominator}")
        };
        let (before, after) = (&self.text[..begin], &self.text[self.at.end..]);
        Ok(format!("{before}{scaled}{after}"))
    }
}

/// A factor as a ratio of small integers, to a thousandth.
fn ratio(factor: f64) -> (u32, u32) {
    let thousandths = (factor * 1000.0).round().clamp(1.0, 1e6) as u32;
    let divisor = gcd(thousandths, 1000);
    (thousandths / divisor, 1000 / divisor)
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: &str = "\
//! A kernel.

/// A gate, metres.
const GATE_M: f64 = 0.04;
pub(crate) const N_MAX: usize = 2 * 8;
const NAMES: [&str; 2] = [\"a\", \"b\"];
const LONG_M: f32 =
    1.0 / 3.0;

impl Default for RawConfig {
    fn default() -> Self {
        Self {
            plane_band_min_m: 0.005,
            n_samples: 400,
            rule: Rule::default(),
        }
    }
}

impl Other {
    fn new() -> Self {
        Self { x: 0, y: 1.0, }
    }
}

#[cfg(test)]
mod tests {
    const IN_TEST: f64 = 1.0;
}
";

    fn constants() -> Vec<Constant> {
        all(Path::new("kernel.rs"), SOURCE)
    }

    #[test]
    fn constants_and_default_fields_are_found_outside_tests() {
        let found: Vec<_> = constants()
            .into_iter()
            .map(|constant| (constant.name, constant.expression, constant.is_float))
            .collect();
        let expected = [
            ("GATE_M", "0.04", true),
            ("N_MAX", "2 * 8", false),
            ("LONG_M", "1.0 / 3.0", true),
            ("plane_band_min_m", "0.005", true),
            ("n_samples", "400", false),
        ];
        let expected = expected.map(|(n, e, f)| (n.to_owned(), e.to_owned(), f));
        assert_eq!(found, expected);
    }

    #[test]
    fn scaling_changes_only_the_expression() {
        let constants = constants();
        for (i, scaled) in [
            (0, "const GATE_M: f64 = (0.04) * 0.5;"),
            (1, "const N_MAX: usize = (2 * 8) * 1 / 2;"),
            (3, "plane_band_min_m: (0.005) * 0.5,"),
        ] {
            let text = constants[i].scaled(0.5).unwrap();
            assert!(text.contains(scaled), "{text}");
            assert_eq!(text.lines().count(), SOURCE.lines().count());
        }
        assert!(constants[0].scaled(f64::NAN).is_err());
    }
}
