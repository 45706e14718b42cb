//! Configuration file `tabula.toml` with one section per process.

use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use std::{fmt, io};

/// Sections of the file: one for each process, and `run` for their parent.
const SECTIONS: [&str; 5] = ["run", "camera", "simulator", "perception", "memory"];

/// Largest accepted configuration file, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// Configuration file of all processes, each with its own section.
#[derive(Debug, Clone, Default)]
pub struct ConfigFile {
    path: Option<PathBuf>,
    text: String,
}

/// Error of an unusable configuration.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// Configuration file that cannot be read.
    #[error("could not read the configuration {}: {source}", .path.display())]
    Unreadable {
        /// Path of the configuration file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Configuration file with invalid content.
    #[error("the configuration {} is wrong: {}", .path.display(), .cause.trim_end())]
    Wrong {
        /// Path of the configuration file.
        path: PathBuf,
        /// Position of the error in the file and its reason.
        cause: String,
    },
}

impl ConfigFile {
    /// Reads the given file, or else the first that exists: `tabula.toml` in the home
    /// folder, `/etc/tabula/tabula.toml`. Without any, all defaults.
    ///
    /// # Errors
    /// When the file cannot be read, is no TOML, or has an unknown section.
    pub fn find(given: Option<&Path>, home: &Path) -> Result<Self, ConfigError> {
        let places = [
            home.join("tabula.toml"),
            PathBuf::from("/etc/tabula/tabula.toml"),
        ];
        let found = || places.into_iter().find(|path| path.exists());
        let Some(path) = given.map(Path::to_owned).or_else(found) else {
            return Ok(Self::default());
        };
        let text = read(&path).map_err(|source| ConfigError::Unreadable {
            path: path.clone(),
            source,
        })?;
        let file = Self {
            path: Some(path),
            text,
        };
        file.check_sections()?;
        Ok(file)
    }

    /// Path of the configuration file, if any.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// Parses one process's section; the default when it is missing.
    ///
    /// # Errors
    /// When a key is unknown or a value is invalid.
    pub fn section<T: DeserializeOwned + Default>(&self, name: &str) -> Result<T, ConfigError> {
        let mut table: toml::Table = toml::from_str(&self.text).map_err(|e| self.wrong(e))?;
        match table.remove(name) {
            None => Ok(T::default()),
            Some(section) => section
                .try_into()
                .map_err(|error| self.wrong(format!("in the section [{name}]: {error}"))),
        }
    }

    /// Creates an error about this configuration file.
    pub fn wrong(&self, cause: impl fmt::Display) -> ConfigError {
        let path = self
            .path
            .clone()
            .unwrap_or_else(|| PathBuf::from("(built-in defaults)"));
        ConfigError::Wrong {
            path,
            cause: cause.to_string(),
        }
    }

    fn check_sections(&self) -> Result<(), ConfigError> {
        let table: toml::Table = toml::from_str(&self.text).map_err(|e| self.wrong(e))?;
        match table.keys().find(|key| !SECTIONS.contains(&key.as_str())) {
            None => Ok(()),
            Some(key) => Err(self.wrong(format!(
                "there is no section [{key}]; the sections are {}",
                SECTIONS.map(|name| format!("[{name}]")).join(", ")
            ))),
        }
    }
}

/// First rule of a section that is not kept, of pairs of whether it is and its sentence.
///
/// # Errors
/// The sentence of that rule.
pub fn check_rules<const N: usize>(rules: [(bool, &'static str); N]) -> Result<(), &'static str> {
    match rules.into_iter().find(|(is_kept, _)| !is_kept) {
        Some((_, rule)) => Err(rule),
        None => Ok(()),
    }
}

fn read(path: &Path) -> io::Result<String> {
    if std::fs::metadata(path)?.len() > MAX_BYTES {
        return Err(io::Error::new(
            io::ErrorKind::InvalidData,
            "it is larger than 1 MiB",
        ));
    }
    std::fs::read_to_string(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Default, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    struct Camera {
        rate_hz: f64,
    }

    fn read_section(text: &str) -> Result<Camera, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tabula.toml");
        std::fs::write(&path, text).unwrap();
        let file = ConfigFile::find(Some(&path), folder.path()).map_err(|e| e.to_string())?;
        file.section("camera").map_err(|e| e.to_string())
    }

    #[test]
    fn a_section_is_read_and_defaults_fill_the_rest() {
        assert_eq!(
            read_section("[camera]\nrate_hz = 5.0"),
            Ok(Camera { rate_hz: 5.0 })
        );
        assert_eq!(read_section("[memory]\n"), Ok(Camera::default()));
        assert_eq!(
            ConfigFile::default().section::<Camera>("camera").unwrap(),
            Camera::default()
        );
    }

    /// Any text is a configuration or is refused with a sentence.
    #[test]
    fn fuzz_configuration_files() {
        let seeds = [
            b"[camera]\nrate_hz = 5.0\n[memory]\nqueue_requests = 3\n".to_vec(),
            b"[run]\n\n[camera]\nrate_hz = 1e3 # fast\n".to_vec(),
        ];
        mutation_fuzzing::fuzz(&seeds, |bytes| {
            let text = String::from_utf8_lossy(bytes).into_owned();
            let file = ConfigFile { path: None, text };
            let camera = file.check_sections().and_then(|()| file.section("camera"));
            match camera {
                Ok(Camera { .. }) => assert!(toml::from_str::<toml::Table>(&file.text).is_ok()),
                Err(error) => assert!(error.to_string().contains("the configuration")),
            }
        });
    }

    #[test]
    fn errors_name_the_problem_and_the_file() {
        let check = |text: &str, word: &str| {
            let sentence = read_section(text).unwrap_err();
            assert!(
                sentence.contains(word) && sentence.contains("tabula.toml"),
                "{sentence}"
            );
        };
        check("[camera]\nrate = 5.0", "rate");
        check("[camera]\nrate_hz = \"fast\"", "rate_hz");
        check("[kamera]\n", "[kamera]");
        check("[camera", "TOML");
        let nowhere = ConfigFile::find(Some(Path::new("/nowhere/x.toml")), Path::new("/nowhere"));
        assert!(nowhere.unwrap_err().to_string().contains("/nowhere/x.toml"));
    }
}
