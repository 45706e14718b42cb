//! `tabula config explain`: meaning, range, default and value of a key.

use super::find;
use super::show::KeyValue;
use command_line::Output;
use serde::Serialize;
use service::{
    CommonArguments, Configuration, Failure, KeyDescription, KeyReference, nearest_names,
};
use std::process::ExitCode;

/// JSON document of `tabula config explain`.
#[derive(Serialize)]
struct ExplainDocument {
    /// The key, in each section that has it.
    keys: Vec<KeyDocument>,
}

/// Explanation of a key in one section.
#[derive(Serialize)]
struct KeyDocument {
    name: String,
    meaning: String,
    #[serde(rename = "type")]
    kind: &'static str,
    /// Range or choices, with the unit; empty for a key without.
    range: String,
    default: Option<String>,
    is_live: bool,
    /// Value that applies; none when the configuration cannot be read.
    value: Option<KeyValue>,
    /// Reason why the value is not known; empty otherwise.
    note: String,
}

/// Runs `tabula config explain`.
pub(super) fn run(
    common: &CommonArguments,
    name: &str,
    output: &Output,
) -> Result<ExitCode, Failure> {
    let descriptions = named(name)?;
    let found = find(common);
    let document = ExplainDocument {
        keys: descriptions
            .into_iter()
            .map(|(description, key)| KeyDocument::new(description, key, &found))
            .collect(),
    };
    let texts = || document.keys.iter().map(KeyDocument::text);
    output.answer(&document, || texts().collect::<Vec<_>>().join("\n\n"));
    Ok(ExitCode::SUCCESS)
}

/// Keys of a name, `perception.workers` or `workers`.
///
/// # Errors
/// When there is none; the sentence has the nearest names.
fn named(name: &str) -> Result<Vec<(&'static KeyDescription, &str)>, Failure> {
    let all = KeyReference::get().keys();
    let in_section = |one: &KeyDescription| name.strip_prefix(one.section)?.strip_prefix('.');
    let found: Vec<_> = all
        .iter()
        .filter_map(|one| {
            let key = in_section(one).unwrap_or(name);
            one.describes(key).then_some((one, key))
        })
        .collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let key = name.rsplit('.').next().unwrap_or(name);
    let near = nearest_names(key, all.iter().map(|one| one.key));
    let near: Vec<String> = all
        .iter()
        .filter(|one| near.contains(&one.key))
        .map(KeyDescription::full_name)
        .collect();
    Err(Failure::usage(format!(
        "there is no key {name:?}; perhaps {} is meant, and `tabula config show` lists all",
        near.join(" or ")
    )))
}

impl KeyDocument {
    fn new(
        description: &KeyDescription,
        key: &str,
        found: &Result<Configuration, Failure>,
    ) -> Self {
        let range = match &description.range {
            Some(range) => range.to_string(),
            None => description.choices.join(", "),
        };
        let (value, note) = match found {
            Ok(found) => (Some(KeyValue::of(found, description, key)), String::new()),
            Err(failure) => (None, failure.sentence.clone()),
        };
        Self {
            name: format!("{}.{key}", description.section),
            meaning: description.meaning.clone(),
            kind: description.kind.word(),
            range,
            default: description.default.as_ref().map(ToString::to_string),
            is_live: description.is_live,
            value,
            note,
        }
    }

    fn text(&self) -> String {
        let kind = match self.range.as_str() {
            "" => self.kind.to_owned(),
            range => format!("{}, {range}", self.kind),
        };
        let value = match &self.value {
            None => format!("not known: {}", self.note),
            Some(value) => match (&value.toml, &value.file, value.line) {
                (Some(text), Some(file), Some(line)) => format!("{text}, from {file} line {line}"),
                (Some(text), ..) => format!("{text}, the default"),
                (None, ..) => "none".to_owned(),
            },
        };
        let change = if self.is_live {
            "while running, by `tabula config reload`"
        } else {
            "needs a restart"
        };
        format!(
            "{}: {}\n  type     {kind}\n  default  {}\n  value    {value}\n  change   {change}",
            self.name,
            self.meaning,
            self.default.as_deref().unwrap_or("none"),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn key_is_found_with_and_without_its_section() {
        let names = |name| -> Vec<String> {
            let found = named(name).unwrap();
            found.into_iter().map(|(one, _)| one.full_name()).collect()
        };
        assert_eq!(names("workers"), ["perception.workers"]);
        assert_eq!(names("perception.workers"), ["perception.workers"]);
        assert_eq!(names("rate_hz"), ["camera.rate_hz", "simulator.rate_hz"]);
        assert_eq!(names("places.shelf.outline"), ["places.NAME.outline"]);
    }

    #[test]
    fn unknown_key_is_refused_with_the_nearest_names() {
        for name in ["worker", "perception.wrokers", "memory.workers"] {
            let failure = named(name).unwrap_err();
            assert!(failure.sentence.contains("perception.workers"), "{failure}");
        }
        assert!(named("").is_err());
    }

    #[test]
    fn explanation_has_meaning_range_default_and_value() {
        let explained = |name| {
            let found = Ok(Configuration::default());
            let (description, key) = named(name).unwrap()[0];
            KeyDocument::new(description, key, &found).text()
        };
        let text = explained("memory.write_buffer_mb");
        for word in [
            "Write buffer",
            "integer, 1 to 256 MB",
            "16, the default",
            "restart",
        ] {
            assert!(text.contains(word), "{word}: {text}");
        }
        let text = explained("depth_noise");
        assert!(text.contains("kinect-v1, stereo, time-of-flight"), "{text}");
        assert!(explained("range_max_m").contains("range_min_m to 10 m"));
        assert!(explained("range_max_m").contains("while running"));
        assert!(explained("camera.source").contains("value    none"));
        let text = explained("places.shelf.outline");
        assert!(text.starts_with("places.shelf.outline: Outline"), "{text}");
    }
}
