//! Key reference: the explanation, type, range and default of every configuration key, read from
//! the example file `deploy/tabula.toml`.
//!
//! There a key is a paragraph of comments: the explanation, a line in brackets, and the key with
//! its default, or with an example when the brackets say `no default`:
//!
//! ```toml
//! # Nearest depth that is used.
//! # [float, 0.1 to 10 m, live]
//! # range_min_m = 0.35
//! ```
//!
//! In a section with names `NAME` stands for any of them.

use super::key_value_check::{KeyRange, ValueKind, check};
use super::split_name;
use crate::Failure;
use std::sync::LazyLock;
use toml::{Table, Value};

/// Text of the reference.
const TEXT: &str = include_str!("../../../../../deploy/tabula.toml");

/// Description of one key.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyDescription {
    /// Section of the key.
    pub section: &'static str,
    /// Name of the key.
    pub key: &'static str,
    /// Explanation, one line of sentences.
    pub meaning: String,
    /// Type of its values.
    pub kind: ValueKind,
    /// Range of a number.
    pub range: Option<KeyRange>,
    /// Values of a text that has only certain ones; empty for others.
    pub choices: Vec<&'static str>,
    /// Value without a setting; `None` for a key that then has no effect.
    pub default: Option<Value>,
    /// Valid value: the default, where there is one.
    pub example: Value,
    /// True if a running process takes a change; otherwise it needs a restart.
    pub is_live: bool,
}

impl KeyDescription {
    /// Name with its section, such as `perception.workers`.
    pub fn full_name(&self) -> String {
        format!("{}.{}", self.section, self.key)
    }

    /// True for the description of a key of its section, with any name in a section with names.
    pub fn describes(&self, key: &str) -> bool {
        let parts = |key| split_name(self.section, key);
        match (parts(self.key), parts(key)) {
            (Some((_, of_any)), Some((_, of_one))) => of_any == of_one,
            _ => self.key == key,
        }
    }

    /// True if the key stands for those of all names of its section.
    pub fn is_of_names(&self) -> bool {
        split_name(self.section, self.key).is_some()
    }

    /// Checks a value against type and range. `number_of` gives the value of another key of the
    /// section.
    ///
    /// # Errors
    /// The rule, the end of a sentence that begins with the key.
    pub(super) fn check(
        &self,
        value: &Value,
        number_of: impl Fn(&str) -> Option<f64>,
    ) -> Result<(), String> {
        check(
            value,
            self.kind,
            self.range.as_ref(),
            &self.choices,
            number_of,
        )
    }
}

/// Descriptions of all keys, in the order of the example file.
#[derive(Debug, Default)]
pub struct KeyReference {
    keys: Vec<KeyDescription>,
}

impl KeyReference {
    /// Key reference of this version.
    pub fn get() -> &'static Self {
        static REFERENCE: LazyLock<KeyReference> = LazyLock::new(|| KeyReference::parse(TEXT).0);
        &REFERENCE
    }

    /// Descriptions of all keys.
    pub fn keys(&self) -> &[KeyDescription] {
        &self.keys
    }

    /// Descriptions of the keys of a section.
    pub fn section(&self, section: &str) -> impl Iterator<Item = &KeyDescription> {
        self.keys.iter().filter(move |one| one.section == section)
    }

    /// Description of a key; `None` for an unknown one.
    pub fn key(&self, section: &str, key: &str) -> Option<&KeyDescription> {
        self.section(section).find(|one| one.describes(key))
    }

    /// Checks the number of an option that overrides a key against the range of the key.
    ///
    /// # Errors
    /// A usage failure that names the option, the range and the number.
    pub fn check_option(section: &str, key: &str, option: &str, value: f64) -> Result<(), Failure> {
        let range = Self::get()
            .key(section, key)
            .and_then(|one| one.range.as_ref());
        range
            .map_or(Ok(()), |range| range.check(value, &value, |_| None))
            .map_err(|rule| Failure::usage(format!("{option} {rule}")))
    }

    /// Reads the descriptions; also returns the lines that cannot be read, which tests refuse.
    fn parse(text: &'static str) -> (Self, Vec<&'static str>) {
        let (mut reference, mut unread) = (Self::default(), Vec::new());
        let mut section = "";
        let mut paragraph = Paragraph::default();
        for line in text.lines() {
            if let Some(name) = line.strip_prefix('[') {
                section = name.trim_end_matches(']');
            }
            let Some(comment) = line.strip_prefix('#') else {
                paragraph = Paragraph::default();
                continue;
            };
            let comment = comment.trim();
            let brackets = comment
                .strip_prefix('[')
                .and_then(|rest| rest.strip_suffix(']'));
            match (brackets, paragraph.brackets) {
                (None, None) => paragraph.sentences.push(comment),
                (Some(brackets), None) => paragraph.brackets = Some(brackets),
                (_, Some(brackets)) => match paragraph.describe(section, brackets, comment) {
                    Some(description) => reference.keys.push(description),
                    None => unread.push(line),
                },
            }
        }
        (reference, unread)
    }
}

/// Lines of comments above a key.
#[derive(Default)]
struct Paragraph {
    sentences: Vec<&'static str>,
    /// Type, range and liveness, without the brackets.
    brackets: Option<&'static str>,
}

impl Paragraph {
    /// Description of the key in a line `key = value`; `None` when the line or the brackets cannot
    /// be read.
    fn describe(
        &self,
        section: &'static str,
        brackets: &'static str,
        line: &'static str,
    ) -> Option<KeyDescription> {
        let (key, _) = line.split_once(" = ")?;
        let mut example = Value::from(toml::from_str::<Table>(line).ok()?);
        for part in key.split('.') {
            example = example.as_table_mut()?.remove(part)?;
        }
        let words: Vec<&'static str> = brackets.split(", ").collect();
        let [kind, others @ .., change] = words.as_slice() else {
            return None;
        };
        if !["live", "restart"].contains(change) {
            return None;
        }
        let mut description = KeyDescription {
            section,
            key,
            meaning: self.sentences.join(" "),
            kind: ValueKind::named(kind)?,
            range: None,
            choices: Vec::new(),
            default: Some(example.clone()),
            example,
            is_live: *change == "live",
        };
        for word in others.iter().copied() {
            if word == "no default" {
                description.default = None;
            } else if word.contains(" | ") {
                description.choices = word.split(" | ").collect();
            } else {
                description.range = Some(KeyRange::parse(word)?);
            }
        }
        Some(description)
    }
}

#[cfg(test)]
mod tests {
    use super::super::SECTIONS;
    use super::*;
    use std::collections::{BTreeMap, BTreeSet};

    #[test]
    fn key_reference_is_read_completely() {
        let (reference, unread) = KeyReference::parse(TEXT);
        assert_eq!(unread, Vec::<&str>::new());
        let is_key = |line: &&str| {
            let key = line
                .strip_prefix("# ")
                .and_then(|rest| rest.split_once(" = "));
            key.is_some_and(|(key, _)| key.chars().all(|c| "_.".contains(c) || c.is_alphanumeric()))
        };
        let n_written = TEXT.lines().filter(is_key).count();
        assert_eq!(reference.keys().len(), n_written, "a key without brackets");
        assert!(n_written > 40);
        let names: BTreeSet<String> = reference
            .keys
            .iter()
            .map(KeyDescription::full_name)
            .collect();
        assert_eq!(names.len(), n_written, "a key is there twice");
        let sections: BTreeSet<&str> = reference.keys().iter().map(|one| one.section).collect();
        assert_eq!(sections, SECTIONS.into_iter().collect());
    }

    #[test]
    fn key_reference_has_valid_examples_and_explanations() {
        let reference = KeyReference::get();
        for one in reference.keys() {
            let number_of = |key: &str| {
                let other = reference.key(one.section, key).expect(key);
                super::super::as_number(other.default.as_ref().unwrap())
            };
            assert_eq!(one.check(&one.example, number_of), Ok(()), "{one:?}");
            assert!(
                one.meaning.len() > 10 && one.meaning.ends_with('.'),
                "{one:?}"
            );
            let is_number = matches!(one.kind, ValueKind::Integer | ValueKind::Float);
            assert_eq!(one.range.is_some(), is_number, "{one:?}");
        }
    }

    /// Cells of the tables of keys in the guide, by section and key: type, default, change.
    fn guide() -> BTreeMap<(String, String), [String; 3]> {
        const GUIDE: &str = include_str!("../../../../../docs/guides/configuration.md");
        let mut section = "";
        let mut rows = BTreeMap::new();
        for line in GUIDE.lines() {
            if line.starts_with('#') && !line.starts_with("####") {
                section = line.split(['[', ']']).nth(1).unwrap_or_default();
            }
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let key = cells.get(1).and_then(|cell| cell.strip_prefix('`'));
            if let (Some(key), [_, _, kind, default, _, change, ..]) = (key, &cells[..])
                && SECTIONS.contains(&section)
            {
                let name = (section.to_owned(), key.trim_end_matches('`').to_owned());
                let row = [*kind, default.trim_matches('`'), *change].map(str::to_owned);
                rows.insert(name, row);
            }
        }
        rows
    }

    #[test]
    fn key_reference_agrees_with_the_guide() {
        let mut guide = guide();
        for one in KeyReference::get().keys() {
            let name = (one.section.to_owned(), one.key.to_owned());
            let Some([kind, default, change]) = guide.remove(&name) else {
                panic!("the guide does not have {name:?}");
            };
            assert_eq!(kind, one.kind.word(), "{name:?}");
            assert_eq!(
                change,
                if one.is_live { "live" } else { "restart" },
                "{name:?}"
            );
            let written = toml::from_str::<Table>(&format!("x = {default}"));
            let (Ok(written), Some(expected)) = (&written, &one.default) else {
                // A default in words.
                assert!(
                    one.default.is_none() || default == "see below",
                    "{name:?} {default}"
                );
                continue;
            };
            let number = super::super::as_number;
            assert_eq!(number(&written["x"]), number(expected), "{name:?}");
            if number(expected).is_none() {
                assert_eq!(&written["x"], expected, "{name:?}");
            }
        }
        assert!(guide.is_empty(), "the reference does not have {guide:?}");
    }

    #[test]
    fn key_description_holds_everything_of_its_paragraph() {
        const EXAMPLE: &str = "[run]\n\n# It barks\n# at you.\n# [float, 4 to 3600 s, live]\n# dog_s = \
                               4.0\n\n# Its name.\n# [string, a | b, no default, restart]\n# name = \
                               \"a\"\n";
        let (reference, unread) = KeyReference::parse(EXAMPLE);
        assert!(unread.is_empty());
        let dog = reference.key("run", "dog_s").unwrap();
        assert_eq!(dog.meaning, "It barks at you.");
        assert_eq!(dog.default, Some(Value::Float(4.0)));
        assert_eq!(dog.range.as_ref().unwrap().unit, "s");
        assert!(dog.is_live);
        let name = reference.key("run", "name").unwrap();
        assert_eq!((name.default.as_ref(), name.is_live), (None, false));
        assert_eq!(name.choices, ["a", "b"]);
        let (none, unread) = KeyReference::parse("[run]\n# x\n# [float, live, 3]\n# dog_s = 4.0\n");
        assert_eq!((none.keys().len(), unread.len()), (0, 1));
    }
}
