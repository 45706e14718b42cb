//! `tabula config show`: the values that apply, with their origin.

use super::{files, find};
use command_line::Output;
use serde::Serialize;
use service::{CommonArguments, Configuration, Failure, KeyDescription, KeyReference, SECTIONS};
use std::fmt::Write as _;
use std::process::ExitCode;

/// Width of a setting, behind which its origin stands.
const WIDTH: usize = 36;

/// JSON document of `tabula config show`.
#[derive(Serialize)]
struct ShowDocument {
    /// Files of the configuration, the later ones win; empty for the defaults.
    files: Vec<String>,
    values: Vec<KeyValue>,
}

/// Value of a key that applies.
#[derive(Debug, Serialize)]
pub(super) struct KeyValue {
    section: &'static str,
    key: String,
    /// Value; none for a key that is not set and has no default.
    pub(super) value: Option<serde_json::Value>,
    /// Value as written in TOML.
    #[serde(skip)]
    pub(super) toml: Option<String>,
    /// File that sets the value; none for a default.
    pub(super) file: Option<String>,
    /// Line in the file, from 1.
    pub(super) line: Option<usize>,
}

/// Runs `tabula config show`.
pub(super) fn run(common: &CommonArguments, output: &Output) -> Result<ExitCode, Failure> {
    let found = find(common)?;
    let document = ShowDocument::of(&found);
    output.answer(&document, || text(&document));
    Ok(ExitCode::SUCCESS)
}

impl ShowDocument {
    /// Values of all keys: in a section with names those of the names that a file has.
    fn of(found: &Configuration) -> Self {
        let value = |description: &'static KeyDescription| {
            let names = found.keys(description.section);
            let set = names.filter(|key| description.is_of_names() && description.describes(key));
            let alone = (!description.is_of_names()).then_some(description.key);
            let keys: Vec<&str> = set.chain(alone).collect();
            let values = keys
                .into_iter()
                .map(|key| KeyValue::of(found, description, key));
            values.collect::<Vec<_>>()
        };
        Self {
            files: files(found),
            values: KeyReference::get().keys().iter().flat_map(value).collect(),
        }
    }
}

impl KeyValue {
    /// Value of a key in a configuration.
    pub(super) fn of(found: &Configuration, description: &KeyDescription, key: &str) -> Self {
        let section = description.section;
        let value = found.effective(section, key);
        let setting = found.setting(section, key);
        Self {
            section,
            key: key.to_owned(),
            value: value.and_then(|value| serde_json::to_value(value).ok()),
            toml: value.map(ToString::to_string),
            file: setting.map(|setting| setting.file.display().to_string()),
            line: setting.map(|setting| setting.line),
        }
    }

    /// Line of TOML; a comment for a key without a value.
    fn line(&self) -> String {
        let Some(value) = &self.toml else {
            return format!("# {} has no value", self.key);
        };
        let setting = format!("{} = {value}", self.key);
        let origin = match &self.file {
            Some(file) => format!("from {file}"),
            None => "default".to_owned(),
        };
        format!("{setting:WIDTH$} # {origin}")
    }
}

/// TOML text of the values by section.
fn text(document: &ShowDocument) -> String {
    let mut text = String::new();
    for section in SECTIONS {
        let gap = if text.is_empty() { "" } else { "\n" };
        let _ = writeln!(text, "{gap}[{section}]");
        for value in document.values.iter().filter(|one| one.section == section) {
            let _ = writeln!(text, "{}", value.line());
        }
    }
    text.trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn read(text: &str) -> Configuration {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        Configuration::find(Some(file.path()), Path::new("/nowhere")).unwrap()
    }

    fn shown(found: &Configuration) -> String {
        text(&ShowDocument::of(found))
    }

    #[test]
    fn shown_values_are_a_configuration_with_the_same_values() {
        let found = read(
            "[camera]\nsource = 'a \"quoted\" name'\n[perception]\nworkers = 3\n\
             candidate_rule = \"\"\"C_table\n\"\"\"\n[places.shelf]\n\
             outline = [[0, 0], [1, 0], [0, 1]]\ncategories = ['mug']\n",
        );
        let text = shown(&found);
        let again = read(&text);
        for key in KeyReference::get().keys() {
            let value = |configuration: &Configuration| {
                configuration.effective(key.section, key.key).cloned()
            };
            assert_eq!(value(&found), value(&again), "{text}");
        }
        let outline = |configuration: &Configuration| {
            configuration.effective("places", "shelf.outline").cloned()
        };
        assert!(outline(&again).is_some(), "{text}");
        assert_eq!(outline(&found), outline(&again));
    }

    #[test]
    fn shown_values_have_their_origin() {
        let found = read("[perception]\nworkers = 3\n");
        let file = files(&found).remove(0);
        let text = shown(&found);
        let line = |key: &str| text.lines().find(|line| line.contains(key)).unwrap();
        assert!(line("workers = 3").ends_with(&format!("# from {file}")));
        assert!(line("known_probability_min = 0.5").ends_with("# default"));
        assert_eq!(line("# source"), "# source has no value");
    }
}
