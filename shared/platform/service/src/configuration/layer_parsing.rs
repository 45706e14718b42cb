//! Parsing of one configuration file into settings with their lines.

use super::config_error::one_line;
use super::{ConfigError, NAMED_SECTIONS, SECTIONS, Setting};
use serde::Deserialize;
use std::path::PathBuf;
use std::sync::Arc;
use toml::de::{DeTable, DeValue, ValueDeserializer};
use toml::{Spanned, Value};

/// Longest name in a section with names, bytes.
const MAX_NAME_BYTES: usize = 64;

/// Settings of a file: section, key and value, in no order.
///
/// # Errors
/// When the text is no TOML or has a section or value that the configuration does not have.
pub(super) fn parse(
    file: &Arc<PathBuf>,
    text: &str,
) -> Result<Vec<(&'static str, String, Setting)>, ConfigError> {
    let lines = LineIndex::new(text);
    let wrong = |offset: Option<usize>, cause: String| ConfigError::Wrong {
        path: file.to_path_buf(),
        line: offset.map(|offset| lines.line_of(offset)),
        cause: one_line(&cause),
    };
    let no_toml = |error: &toml::de::Error| {
        let offset = error.span().map(|span| span.start);
        wrong(offset, format!("it is no TOML: {}", error.message()))
    };
    let document = DeTable::parse(text).map_err(|error| no_toml(&error))?;
    let mut settings = Vec::new();
    for (name, section) in document.into_inner() {
        let offset = Some(name.span().start);
        let name = name.into_inner();
        let Some(known) = SECTIONS.into_iter().find(|known| *known == name) else {
            let cause = format!(
                "there is no section [{name}]; the sections are {}",
                SECTIONS.map(|name| format!("[{name}]")).join(", ")
            );
            return Err(wrong(offset, cause));
        };
        let DeValue::Table(keys) = section.into_inner() else {
            let cause = format!("{known} is a section, written [{known}], and no value");
            return Err(wrong(offset, cause));
        };
        for (key, value) in keys {
            let offset_of_key = key.span().start;
            let key = key.into_inner().into_owned();
            let settings_of = if NAMED_SECTIONS.contains(&known) {
                named_values(known, &key, value).map_err(|cause| wrong(offset, cause))?
            } else {
                vec![(key, offset_of_key, value)]
            };
            for (key, offset, value) in settings_of {
                let setting = Setting {
                    value: value_of(value).map_err(|error| no_toml(&error))?,
                    file: Arc::clone(file),
                    line: lines.line_of(offset),
                };
                settings.push((present_section(known, &key), key, setting));
            }
        }
    }
    Ok(settings)
}

/// Values of the table of a name in a section with names, with the offsets of their keys, which have
/// the name before them.
fn named_values<'a>(
    section: &str,
    name: &str,
    value: Spanned<DeValue<'a>>,
) -> Result<Vec<(String, usize, Spanned<DeValue<'a>>)>, String> {
    let is_letter = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    if name.is_empty() || name.len() > MAX_NAME_BYTES || !name.chars().all(is_letter) {
        return Err(format!(
            "{name:?} is no name for [{section}.NAME]; choose 1 to {MAX_NAME_BYTES} bytes of \
             letters, digits, - and _"
        ));
    }
    let DeValue::Table(keys) = value.into_inner() else {
        return Err(format!(
            "{name} is a name in [{section}], written [{section}.{name}], and no value"
        ));
    };
    let named = keys
        .into_iter()
        .map(|(key, value)| (format!("{name}.{}", key.get_ref()), key.span().start, value));
    Ok(named.collect())
}

/// Section in which a key stands today; an earlier version may have had it in another one.
fn present_section(section: &'static str, key: &str) -> &'static str {
    match (section, key) {
        ("memory", "teacher_group" | "administrator_group") => "gateway",
        _ => section,
    }
}

fn value_of(value: Spanned<DeValue<'_>>) -> Result<Value, toml::de::Error> {
    Value::deserialize(ValueDeserializer::from(value))
}

/// Line numbers of offsets in a text.
struct LineIndex {
    /// Offsets of all line feeds.
    ends: Vec<usize>,
}

impl LineIndex {
    fn new(text: &str) -> Self {
        let ends = text.match_indices('\n').map(|(offset, _)| offset);
        Self {
            ends: ends.collect(),
        }
    }

    /// Line of a byte offset, from 1.
    fn line_of(&self, offset: usize) -> usize {
        self.ends.partition_point(|end| *end < offset) + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Vec<(&'static str, String, Setting)>, String> {
        let file = Arc::new(PathBuf::from("x.toml"));
        parse(&file, text).map_err(|error| error.to_string())
    }

    #[test]
    fn settings_have_the_lines_of_their_keys() {
        let text = "# comment\n[camera]\n\nrate_hz = 5\nloop = true # again\nmemory.x = 1\n";
        let settings = parsed(&text.replace("memory.x = 1\n", "")).unwrap();
        let lines: Vec<_> = settings
            .iter()
            .map(|(section, key, setting)| (*section, key.as_str(), setting.line))
            .collect();
        assert_eq!(lines, [("camera", "loop", 5), ("camera", "rate_hz", 4)]);
        let dotted = parsed("memory.queue_requests = 3\nrun = { watchdog_s = 5 }").unwrap();
        assert_eq!((dotted[0].0, dotted[0].2.line), ("memory", 1));
        assert_eq!((dotted[1].0, dotted[1].2.line), ("run", 2));
    }

    #[test]
    fn keys_of_a_named_table_have_its_name() {
        let text = "[places.shelf]\nheight_m = 1\n[places]\nbox.height_m = 2\n";
        let settings = parsed(text).unwrap();
        let keys: Vec<_> = settings
            .iter()
            .map(|(_, key, setting)| (key.as_str(), setting.line))
            .collect();
        assert_eq!(keys, [("box.height_m", 4), ("shelf.height_m", 2)]);
        for wrong in ["[places]\nshelf = 3\n", "[places.'a b']\nheight_m = 1\n"] {
            assert!(parsed(wrong).unwrap_err().contains("name"), "{wrong}");
        }
    }

    #[test]
    fn key_of_an_earlier_section_counts_in_its_present_one() {
        let text = "[memory]\nteacher_group = 'staff'\nqueue_requests = 5\n";
        let settings = parsed(text).unwrap();
        let places: Vec<_> = settings
            .iter()
            .map(|(section, key, _)| (*section, key.as_str()))
            .collect();
        assert!(places.contains(&("gateway", "teacher_group")), "{places:?}");
        assert!(places.contains(&("memory", "queue_requests")), "{places:?}");
    }

    #[test]
    fn errors_name_file_line_and_cause() {
        let check = |text: &str, words: &[&str]| {
            let sentence = parsed(text).unwrap_err();
            for word in ["x.toml", "wrong"].iter().chain(words) {
                assert!(sentence.contains(word), "{word}: {sentence}");
            }
        };
        check("\n[camera", &["TOML", "line 2"]);
        check("[run]\n[kamera]\n", &["[kamera]", "[camera]", "line 2"]);
        check("rate_hz = 5.0", &["[rate_hz]", "line 1"]);
        check("\nmemory = 3", &["[memory]", "line 2"]);
        check("[run]\nx = 1\nx = 2", &["TOML", "line 3"]);
        check("[run]\nx = 99999999999999999999", &["TOML", "line 2"]);
        check("\u{0}", &["TOML"]);
    }
}
