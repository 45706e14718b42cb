//! Installed programs that measure a computer: `cyclictest`, `oslat`, `stress-ng`.

use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::io;
use std::process::{Child, Command, ExitStatus, Stdio};

/// Error of a measuring program; the measurement goes on without it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum Error {
    #[error("{program} is not installed; install the Debian package {package}")]
    NotInstalled {
        program: &'static str,
        package: &'static str,
    },
    #[error("{program} could not be run: {source}")]
    NotRun {
        program: &'static str,
        source: io::Error,
    },
    #[error("{program} ended with {status}: {message}")]
    Failed {
        program: &'static str,
        status: ExitStatus,
        message: String,
    },
    #[error(
        "the result of {program} is not understood: {reason}; install the package of Debian 12"
    )]
    Document {
        program: &'static str,
        reason: String,
    },
}

/// Installed program, with the Debian package that has it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasuringProgram {
    name: &'static str,
    package: &'static str,
}

impl MeasuringProgram {
    /// Timer latency (Gleixner and Williams).
    pub(crate) const CYCLICTEST: Self = Self::new("cyclictest", "rt-tests");
    /// Interruptions of a spinning thread.
    pub(crate) const OSLAT: Self = Self::new("oslat", "rt-tests");
    /// Memory bandwidth, and load on every core.
    pub(crate) const STRESS_NG: Self = Self::new("stress-ng", "stress-ng");

    const fn new(name: &'static str, package: &'static str) -> Self {
        Self { name, package }
    }

    /// Runs the program to its end, and reads the file that it writes for `option`.
    pub(crate) fn document(self, arguments: &[String], option: &str) -> Result<String, Error> {
        let folder = tempfile::tempdir().map_err(|error| self.not_run(error))?;
        let file = folder.path().join("result");
        let output = Command::new(self.name)
            .args(arguments)
            .arg(option)
            .arg(&file)
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .output()
            .map_err(|error| self.not_run(error))?;
        if !output.status.success() {
            return Err(Error::Failed {
                program: self.name,
                status: output.status,
                message: first_line(&output.stderr),
            });
        }
        std::fs::read_to_string(file).map_err(|error| self.not_run(error))
    }

    /// Starts the program without waiting for its end.
    pub(crate) fn start(self, arguments: &[String]) -> Result<Child, Error> {
        let mut command = Command::new(self.name);
        let silent = command.stdout(Stdio::null()).stderr(Stdio::null());
        let child = silent.args(arguments).spawn();
        child.map_err(|error| self.not_run(error))
    }

    /// Runs a program of `rt-tests` and returns the figures of its first thread.
    pub(crate) fn first_thread<T: DeserializeOwned>(
        self,
        arguments: &[String],
    ) -> Result<T, Error> {
        let text = self.document(arguments, "--json")?;
        let document: ThreadFigures<T> =
            serde_json::from_str(&text).map_err(|error| self.document_error(&error))?;
        let first = document.thread.into_values().next();
        first.ok_or_else(|| self.document_error(&"it has no thread"))
    }

    /// Error about a result that is not understood.
    pub(crate) fn document_error(self, reason: &dyn Display) -> Error {
        Error::Document {
            program: self.name,
            reason: reason.to_string(),
        }
    }

    fn not_run(self, source: io::Error) -> Error {
        let Self { name, package } = self;
        match source.kind() {
            io::ErrorKind::NotFound => Error::NotInstalled {
                program: name,
                package,
            },
            _ => Error::NotRun {
                program: name,
                source,
            },
        }
    }
}

/// JSON document of a program of `rt-tests`: figures by number of the thread.
#[derive(Debug, Deserialize)]
struct ThreadFigures<T> {
    thread: BTreeMap<u32, T>,
}

/// First line of a program's messages that is neither empty nor a warning.
fn first_line(messages: &[u8]) -> String {
    let messages = String::from_utf8_lossy(messages);
    let mut lines = messages.lines().map(str::trim);
    let line = lines.find(|line| !line.is_empty() && !line.starts_with("WARN"));
    line.unwrap_or("no message").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_program_names_its_package() {
        let missing = MeasuringProgram::new("no-such-program", "its-package");
        let said = missing.document(&[], "--json").unwrap_err().to_string();
        assert!(said.contains("no-such-program is not installed") && said.contains("its-package"));
    }

    #[test]
    fn failed_program_is_quoted() {
        let shell = MeasuringProgram::new("sh", "dash");
        let arguments = ["-c", "echo WARN: a >&2; echo no right >&2; exit 3"].map(str::to_owned);
        let said = shell.document(&arguments, "-").unwrap_err().to_string();
        assert!(said.contains("3: no right"), "{said}");
    }
}
