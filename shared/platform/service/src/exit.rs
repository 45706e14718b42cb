//! How a process ends.

use std::error::Error;
use std::fmt;

/// The exit codes of all programs; documented in docs/guides/command-line.md.
pub mod exit_code {
    /// Something failed.
    pub const FAILURE: u8 = 1;
    /// Wrong arguments or configuration.
    pub const USAGE: u8 = 2;
    /// No daemon is running in the domain.
    pub const NO_DAEMON: u8 = 3;
    /// The daemon refused the command.
    pub const REFUSED: u8 = 4;
    /// No answer in time.
    pub const TIMED_OUT: u8 = 5;
    /// Another daemon runs in the domain.
    pub const ALREADY_RUNNING: u8 = 6;
    /// Something measured is over its budget.
    pub const OVER_BUDGET: u8 = 7;
}

/// A sentence for people and an exit code for scripts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// One of [`exit_code`].
    pub code: u8,
    /// What happened, to what, and what to do next.
    pub sentence: String,
}

impl Failure {
    /// A failure with its code.
    pub fn new(code: u8, sentence: impl fmt::Display) -> Self {
        Self {
            code,
            sentence: sentence.to_string(),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence)
    }
}

impl Error for Failure {}

impl From<channel::Error> for Failure {
    fn from(error: channel::Error) -> Self {
        let code = match error {
            channel::Error::RoleTaken { .. } => exit_code::ALREADY_RUNNING,
            channel::Error::DomainName(_) => exit_code::USAGE,
            _ => exit_code::FAILURE,
        };
        Self::new(code, error)
    }
}

impl From<crate::ConfigError> for Failure {
    fn from(error: crate::ConfigError) -> Self {
        Self::new(exit_code::USAGE, error)
    }
}
