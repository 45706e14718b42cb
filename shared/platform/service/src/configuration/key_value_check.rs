//! Type and range of a configuration key: parsing of their description, and check of a value.

use super::as_number;
use std::fmt;
use toml::Value;

coded_enum::coded_enum! {
    /// Type of a value.
    pub enum ValueKind {
        /// Whole number.
        Integer, "integer";
        /// Number; a whole one is accepted.
        Float, "float";
        /// `true` or `false`.
        Boolean, "boolean";
        /// Text.
        String, "string";
        /// List of texts.
        Strings, "strings";
        /// Corners `[x, y]` of a convex outline, in their order around it.
        Outline, "outline";
    }
}

impl ValueKind {
    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.word() == name)
    }

    pub(super) fn accepts(self, value: &Value) -> bool {
        match self {
            Self::Integer => value.is_integer(),
            Self::Float => value.is_float() || value.is_integer(),
            Self::Boolean => value.is_bool(),
            Self::String => value.is_str(),
            Self::Strings => value
                .as_array()
                .is_some_and(|list| list.iter().all(Value::is_str)),
            Self::Outline => corners(value).is_some(),
        }
    }
}

/// Finite corners of an outline; `None` for another value.
fn corners(value: &Value) -> Option<Vec<[f64; 2]>> {
    let corner = |value: &Value| match value.as_array()?.as_slice() {
        [x, y] => Some([as_number(x)?, as_number(y)?]),
        _ => None,
    };
    let corners: Option<Vec<_>> = value.as_array()?.iter().map(corner).collect();
    corners.filter(|all| all.iter().flatten().all(|c| c.is_finite()))
}

/// True for corners around a convex area, in either direction: they turn one way, once.
fn is_convex(corners: &[[f64; 2]]) -> bool {
    let n = corners.len();
    let edge = |k: usize| {
        let ([ax, ay], [bx, by]) = (corners[k % n], corners[(k + 1) % n]);
        [bx - ax, by - ay]
    };
    let turns_rad = (0..n).map(|k| {
        let ([ax, ay], [bx, by]) = (edge(k), edge(k + 1));
        (ax * by - ay * bx).atan2(ax * bx + ay * by)
    });
    let turns_rad: Vec<f64> = turns_rad.collect();
    let one_way =
        turns_rad.iter().all(|turn| *turn > 0.0) || turns_rad.iter().all(|turn| *turn < 0.0);
    n >= 3 && one_way && turns_rad.iter().sum::<f64>().abs() < 1.5 * std::f64::consts::TAU
}

/// Bound of a range: a number, or the value of another key of the section.
#[derive(Debug, Clone, PartialEq)]
pub enum KeyBound {
    /// Fixed bound.
    Number(f64),
    /// Key whose value is the bound.
    Key(&'static str),
}

/// Range of a number, both bounds included, with its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyRange {
    /// Least value.
    pub least: KeyBound,
    /// Greatest value; `None` for a range without one.
    pub most: Option<f64>,
    /// Unit; empty for a number without one.
    pub unit: &'static str,
}

impl KeyRange {
    /// Range described as `4 to 3600 s`, `watchdog_s to 86400 s`, or `from 0 frames`.
    pub(super) fn parse(text: &'static str) -> Option<Self> {
        if let Some(rest) = text.strip_prefix("from ") {
            let (least, unit) = rest.split_once(' ').unwrap_or((rest, ""));
            return Some(Self {
                least: KeyBound::Number(least.parse().ok()?),
                most: None,
                unit,
            });
        }
        let (least, rest) = text.split_once(" to ")?;
        let (most, unit) = rest.split_once(' ').unwrap_or((rest, ""));
        let least = least.parse().map_or(KeyBound::Key(least), KeyBound::Number);
        Some(Self {
            least,
            most: Some(most.parse().ok()?),
            unit,
        })
    }

    /// Bounds as numbers. `number_of` gives the value of another key; without it there is no least
    /// value.
    fn bounds(&self, number_of: impl Fn(&str) -> Option<f64>) -> (f64, f64) {
        let least = match &self.least {
            KeyBound::Number(number) => Some(*number),
            KeyBound::Key(key) => number_of(key),
        };
        let most = self.most.unwrap_or(f64::INFINITY);
        (least.unwrap_or(f64::NEG_INFINITY), most)
    }

    /// Checks a number, which NaN fails.
    ///
    /// # Errors
    /// The rule, the end of a sentence that begins with the key.
    pub(super) fn check(
        &self,
        value: f64,
        written: &dyn fmt::Display,
        number_of: impl Fn(&str) -> Option<f64>,
    ) -> Result<(), String> {
        let (least, most) = self.bounds(number_of);
        if (least..=most).contains(&value) {
            return Ok(());
        }
        let unit = match self.unit {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        let bound = match &self.least {
            KeyBound::Number(number) => number.to_string(),
            KeyBound::Key(key) => format!("{key} ({least})"),
        };
        Err(match self.most {
            Some(most) => format!("must lie between {bound} and {most}{unit}, not {written}"),
            None => format!("must be at least {bound}{unit}, not {written}"),
        })
    }
}

impl fmt::Display for KeyRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let least: &dyn fmt::Display = match &self.least {
            KeyBound::Number(number) => number,
            KeyBound::Key(key) => key,
        };
        match self.most {
            Some(most) => write!(f, "{least} to {most}")?,
            None => write!(f, "from {least}")?,
        }
        match self.unit {
            "" => Ok(()),
            unit => write!(f, " {unit}"),
        }
    }
}

/// Checks that a value has the type, is in the range, and is one of the choices, if there are any.
///
/// # Errors
/// The rule, the end of a sentence that begins with the key.
pub(super) fn check(
    value: &Value,
    kind: ValueKind,
    range: Option<&KeyRange>,
    choices: &[&str],
    number_of: impl Fn(&str) -> Option<f64>,
) -> Result<(), String> {
    if !kind.accepts(value) {
        return Err(format!(
            "must be of the type {}, not the {} {value}",
            kind.word(),
            value.type_str()
        ));
    }
    if kind == ValueKind::Outline && !corners(value).is_some_and(|corners| is_convex(&corners)) {
        return Err(format!(
            "must be three or more corners [x, y] of a convex outline in their order around it, not \
             {value}"
        ));
    }
    if let (Some(range), Some(number)) = (range, as_number(value)) {
        range.check(number, value, number_of)?;
    }
    match value.as_str() {
        Some(text) if !choices.is_empty() && !choices.contains(&text) => Err(format!(
            "must be one of {}, not {text:?}",
            choices.join(", ")
        )),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(text: &str, kind: ValueKind, range: &'static str) -> Result<(), String> {
        let table: toml::Table = toml::from_str(&format!("x = {text}")).unwrap();
        let range = KeyRange::parse(range).unwrap();
        check(&table["x"], kind, Some(&range), &[], |key| {
            (key == "watchdog_s").then_some(5.0)
        })
    }

    #[test]
    fn range_includes_its_bounds_and_nothing_else() {
        for (text, is_inside) in [
            ("4", true),
            ("4.0", true),
            ("3600", true),
            ("3.99", false),
            ("3601", false),
            ("nan", false),
            ("inf", false),
        ] {
            let found = checked(text, ValueKind::Float, "4 to 3600 s");
            assert_eq!(found.is_ok(), is_inside, "{text}");
        }
        let sentence = checked("3", ValueKind::Integer, "4 to 3600 s").unwrap_err();
        assert_eq!(sentence, "must lie between 4 and 3600 s, not 3");
        let sentence = checked("-1", ValueKind::Integer, "from 0 frames").unwrap_err();
        assert_eq!(sentence, "must be at least 0 frames, not -1");
        assert!(checked("9007199254740993", ValueKind::Integer, "from 0").is_ok());
    }

    #[test]
    fn range_may_begin_at_another_key() {
        assert!(checked("5", ValueKind::Float, "watchdog_s to 10 s").is_ok());
        let sentence = checked("4.5", ValueKind::Float, "watchdog_s to 10 s").unwrap_err();
        assert!(sentence.contains("watchdog_s (5)"), "{sentence}");
    }

    #[test]
    fn range_is_written_as_it_is_read() {
        for text in ["4 to 3600 s", "0 to 1", "range_min_m to 10 m", "from 0"] {
            assert_eq!(KeyRange::parse(text).unwrap().to_string(), text);
        }
        assert_eq!(KeyRange::parse("live"), None);
        assert_eq!(KeyRange::parse("1 to many"), None);
    }

    #[test]
    fn value_has_the_type_of_its_key() {
        let check = |value: Value, kind, is_right: bool| {
            let found = check(&value, kind, None, &[], |_| None);
            assert_eq!(found.is_ok(), is_right, "{value} {kind:?}");
        };
        check(Value::Integer(1), ValueKind::Integer, true);
        check(Value::Integer(1), ValueKind::Float, true);
        check(Value::Float(1.0), ValueKind::Integer, false);
        check(Value::Boolean(true), ValueKind::Boolean, true);
        check(Value::String("true".into()), ValueKind::Boolean, false);
        check(Value::Table(toml::Table::new()), ValueKind::String, false);
    }

    #[test]
    fn outline_is_convex_and_in_order() {
        let check = |text: &str| {
            let table: toml::Table = toml::from_str(&format!("x = {text}")).unwrap();
            check(&table["x"], ValueKind::Outline, None, &[], |_| None)
        };
        for right in [
            "[[0, 0], [1, 0], [0, 1]]",
            "[[0.5, 0], [0, 1], [1, 1.5], [2, 0]]",
        ] {
            assert_eq!(check(right), Ok(()), "{right}");
        }
        for wrong in [
            "[]",
            "3",
            "[[0, 0], [1, 0]]",
            "[[0, 0], [1, 0], [2, 0]]",
            "[[0, 0], [1, 1], [1, 0], [0, 1]]",
            "[[0, 0], [2, 0], [0.5, 0.5], [0, 2]]",
            "[[0, 0], [1, 0], [0, 1], [0, 0], [1, 0], [0, 1]]",
            "[[0, 0], [1, 0], [0, nan]]",
            "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]",
        ] {
            assert!(check(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn choice_is_one_of_those_given() {
        let choose = |text: &str| {
            let value = Value::String(text.into());
            check(&value, ValueKind::String, None, &["a", "b"], |_| None)
        };
        assert_eq!(choose("a"), Ok(()));
        assert_eq!(choose("c").unwrap_err(), "must be one of a, b, not \"c\"");
    }
}
