//! Configuration of all processes: `tabula.toml` and its drop-ins, merged key by key.

mod config_error;
mod config_layer;
mod key_reference;
mod key_value_check;
mod layer_parsing;
mod nearest_names;
mod reference_check;

pub use config_error::ConfigError;
pub use key_reference::{KeyDescription, KeyReference};
pub use key_value_check::{KeyBound, KeyRange, ValueKind};
pub use nearest_names::{nearest_names, probable_name};
pub use reference_check::check_section_reference;

pub(crate) use config_error::one_line;
use config_error::printable_line;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::{Table, Value};

/// Sections of the configuration: one for each process, `run` for their parent, and those that
/// several processes read.
pub const SECTIONS: [&str; 10] = [
    "run",
    "shared_memory",
    "gateway",
    "camera",
    "simulator",
    "gripper",
    "places",
    "executive",
    "perception",
    "memory",
];

/// Sections with a table for each of several names, such as `[places.shelf]`. Its keys are those of
/// the section, with the name before them: `shelf.outline`.
const NAMED_SECTIONS: [&str; 1] = ["places"];

/// Beginning of keys that only test programs have, which check them themselves.
const TEST_KEY_PREFIX: &str = "fault_";

/// Value of a key, with its place in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// Value as written.
    pub value: Value,
    /// File that has set it.
    pub file: Arc<PathBuf>,
    /// Line of the key in the file, from 1.
    pub line: usize,
}

/// Configuration of all processes, each with its own section: the settings of a file and of its
/// drop-ins. Of a key that several files set, the value of the last one counts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Configuration {
    files: Vec<Arc<PathBuf>>,
    settings: BTreeMap<&'static str, BTreeMap<String, Setting>>,
}

impl Configuration {
    /// Reads the given file with the drop-ins `FILE.d/*.toml` beside it, or else the first of these
    /// that exists with its own: `tabula.toml` in the home folder, `/etc/tabula/tabula.toml`. A
    /// file exists when it or a drop-in of it does. Without any, all defaults.
    ///
    /// Keys, types and ranges of all sections are checked with the key reference.
    ///
    /// # Errors
    /// When a file cannot be read, is no TOML, or has an unknown section, an unknown key, or a
    /// value of another type or out of range. The sentence names the file and the line.
    pub fn find(given: Option<&Path>, home: &Path) -> Result<Self, ConfigError> {
        let found = Self::merge(config_layer::find(given, home)?)?;
        found.check()?;
        Ok(found)
    }

    /// Merges texts with their paths, in the order of precedence, the last one wins.
    fn merge(layers: Vec<config_layer::ConfigLayer>) -> Result<Self, ConfigError> {
        let mut merged = Self::default();
        for layer in layers {
            let file = Arc::new(layer.path);
            for (section, key, setting) in layer_parsing::parse(&file, &layer.text)? {
                merged.set(section, key, setting);
            }
            merged.files.push(file);
        }
        Ok(merged)
    }

    /// `true` for the configuration of the systemd services, in `/etc`.
    pub fn is_of_services(&self) -> bool {
        let folder = Path::new(config_layer::SYSTEM_FILE).parent();
        self.files()
            .any(|file| folder.is_some_and(|folder| file.starts_with(folder)))
    }

    /// Files that were read, in the order of reading; none for the defaults.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|file| file.as_path())
    }

    /// Files as text, for the log.
    pub fn origin(&self) -> String {
        let files: Vec<String> = self
            .files()
            .map(|file| file.display().to_string())
            .collect();
        match files.as_slice() {
            [] => "built in".to_owned(),
            files => files.join(", "),
        }
    }

    /// Setting of a key; `None` when no file sets it.
    pub fn setting(&self, section: &str, key: &str) -> Option<&Setting> {
        self.settings.get(section)?.get(key)
    }

    /// Value of a key that applies: that of a file, or the default. `None` for a key without
    /// either.
    pub fn effective(&self, section: &str, key: &str) -> Option<&Value> {
        let default = || KeyReference::get().key(section, key)?.default.as_ref();
        self.setting(section, key)
            .map(|setting| &setting.value)
            .or_else(default)
    }

    /// Keys that files set in a section, in alphabetical order.
    pub fn keys(&self, section: &str) -> impl Iterator<Item = &str> {
        let settings = self.settings.get(section).into_iter().flatten();
        settings.map(|(key, _)| key.as_str())
    }

    /// Sets a key.
    pub(crate) fn set(&mut self, section: &'static str, key: String, setting: Setting) {
        let settings = self.settings.entry(section).or_default();
        settings.insert(key, setting);
    }

    /// Removes a key, so that its default applies.
    pub(crate) fn unset(&mut self, section: &str, key: &str) {
        if let Some(settings) = self.settings.get_mut(section) {
            settings.remove(key);
        }
    }

    /// Parses the keys of a section that files set, checked with the key reference.
    ///
    /// # Errors
    /// When a key is unknown to the process, or its value has another type or is out of range.
    pub fn section<T: DeserializeOwned>(&self, name: &str) -> Result<T, ConfigError> {
        self.parse_section(name, &Table::new())
    }

    /// Parses a section like [`section`](Self::section); keys that no file sets have their
    /// defaults.
    ///
    /// # Errors
    /// As for [`section`](Self::section).
    pub fn section_with_defaults<T: DeserializeOwned>(&self, name: &str) -> Result<T, ConfigError> {
        let keys = KeyReference::get().section(name);
        let defaults = keys.filter_map(|one| Some((one.key.to_owned(), one.default.clone()?)));
        self.parse_section(name, &defaults.collect())
    }

    fn parse_section<T: DeserializeOwned>(
        &self,
        name: &str,
        defaults: &Table,
    ) -> Result<T, ConfigError> {
        self.check_section(name)?;
        let parse = |settings: &mut dyn Iterator<Item = (&String, &Setting)>| {
            let mut table = defaults.clone();
            for (key, setting) in settings {
                insert(&mut table, name, key, setting.value.clone());
            }
            table.try_into::<T>()
        };
        let settings = || self.settings.get(name).into_iter().flatten();
        parse(&mut settings()).map_err(|error| {
            // Keys do not depend on each other here, so the wrong one is wrong alone, too.
            let wrong = settings().find(|one| parse(&mut std::iter::once(*one)).is_err());
            let keys: Vec<&str> = wrong.iter().map(|(key, _)| key.as_str()).collect();
            let name_of_key = keys.first().copied().unwrap_or_default();
            let cause = format!("[{name}] {name_of_key}: {}", error.message());
            self.error_at(name, &keys, printable_line(&cause))
        })
    }

    /// Error about the values of keys in a section. It names the place of the first of the keys
    /// that a file sets.
    pub fn wrong(&self, section: &str, keys: &[&str], cause: impl fmt::Display) -> ConfigError {
        self.error_at(section, keys, one_line(&format!("[{section}] {cause}")))
    }

    fn error_at(&self, section: &str, keys: &[&str], cause: String) -> ConfigError {
        let setting = keys.iter().find_map(|key| self.setting(section, key));
        let path = match (setting, self.files.first()) {
            (Some(setting), _) => setting.file.to_path_buf(),
            (None, Some(file)) => file.to_path_buf(),
            (None, None) => PathBuf::from("(built-in defaults)"),
        };
        ConfigError::Wrong {
            path,
            line: setting.map(|setting| setting.line),
            cause,
        }
    }

    /// Checks the settings of all sections against the key reference.
    fn check(&self) -> Result<(), ConfigError> {
        self.settings
            .keys()
            .try_for_each(|name| self.check_section(name))
    }

    /// Checks the settings of a section against the key reference.
    fn check_section(&self, section: &str) -> Result<(), ConfigError> {
        for (key, setting) in self.settings.get(section).into_iter().flatten() {
            self.check_setting(section, key, &setting.value)?;
        }
        self.check_dependent_defaults(section)
    }

    /// Checks the defaults whose range depends on another key, which a file may have set.
    fn check_dependent_defaults(&self, section: &str) -> Result<(), ConfigError> {
        for one in KeyReference::get().section(section) {
            let bound = one.range.as_ref().map(|range| &range.least);
            let (Some(KeyBound::Key(other)), Some(default)) = (bound, &one.default) else {
                continue;
            };
            if self.setting(section, one.key).is_none() {
                let number_of = |key: &str| as_number(self.effective(section, key)?);
                one.check(default, number_of).map_err(|rule| {
                    self.wrong(section, &[*other], format!("{} {rule}", one.key))
                })?;
            }
        }
        Ok(())
    }

    fn check_setting(&self, section: &str, key: &str, value: &Value) -> Result<(), ConfigError> {
        let reference = KeyReference::get();
        let Some(description) = reference.key(section, key) else {
            if key.starts_with(TEST_KEY_PREFIX) {
                return Ok(());
            }
            let names = reference.section(section).map(|known| known.key);
            let near = nearest_names(key, names).join(" or ");
            let cause = format!("there is no key {key:?}; perhaps {near} is meant");
            return Err(self.wrong(section, &[key], cause));
        };
        let number_of = |other: &str| as_number(self.effective(section, other)?);
        description
            .check(value, number_of)
            .map_err(|rule| self.wrong(section, &[key], format!("{key} {rule}")))
    }
}

/// Inserts the value of a key into the table of its section.
fn insert(table: &mut Table, section: &str, key: &str, value: Value) {
    match split_name(section, key) {
        Some((name, key)) => {
            let named = table.entry(name).or_insert_with(|| Table::new().into());
            if let Some(named) = named.as_table_mut() {
                named.insert(key.to_owned(), value);
            }
        }
        None => {
            table.insert(key.to_owned(), value);
        }
    }
}

/// Name and key of a key in a section with names; `None` in other sections.
fn split_name<'a>(section: &str, key: &'a str) -> Option<(&'a str, &'a str)> {
    let is_named = NAMED_SECTIONS.contains(&section);
    is_named.then(|| key.rsplit_once('.')).flatten()
}

/// Number of an integer or a float.
pub(crate) fn as_number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|integer| integer as f64))
}

#[cfg(test)]
mod tests;
