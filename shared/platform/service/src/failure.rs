//! Process failures and exit codes.

use crate::service_manager::is_service;
use std::fmt;

/// Exit codes of all programs; documented in docs/guides/command-line.md.
pub mod exit_code {
    /// Exit code of a general failure.
    pub const FAILURE: u8 = 1;
    /// Exit code of wrong arguments or configuration.
    pub const USAGE: u8 = 2;
    /// Exit code: no daemon is running in the domain.
    pub const NO_DAEMON: u8 = 3;
    /// Exit code: the daemon refused the command.
    pub const REFUSED: u8 = 4;
    /// Exit code of a timeout: no answer from the daemon.
    pub const TIMED_OUT: u8 = 5;
    /// Exit code: another daemon runs in the domain.
    pub const ALREADY_RUNNING: u8 = 6;
    /// Exit code: a measurement is over its budget.
    pub const OVER_BUDGET: u8 = 7;
}

/// Failure of a process: a sentence for people and an exit code for scripts.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{sentence}")]
pub struct Failure {
    /// Exit code of the process, one of [`exit_code`].
    pub code: u8,
    /// Sentence: the problem, the object concerned, and the next step.
    pub sentence: String,
    /// True if what the command names is not there.
    pub is_missing: bool,
}

impl Failure {
    /// Creates a failure with an exit code.
    pub fn new(code: u8, sentence: impl fmt::Display) -> Self {
        Self {
            code,
            sentence: sentence.to_string(),
            is_missing: false,
        }
    }

    /// This failure, of a command that names something that is not there.
    #[must_use]
    pub fn of_missing(self) -> Self {
        Self {
            is_missing: true,
            ..self
        }
    }

    /// Creates a failure with the general exit code.
    pub fn general(sentence: impl fmt::Display) -> Self {
        Self::new(exit_code::FAILURE, sentence)
    }

    /// Failure of a process that has been ready, or not: then wrong usage is no reason not to try
    /// again, because what was right once may be so again.
    pub(crate) fn after_readiness(mut self, has_been_ready: bool) -> Self {
        if has_been_ready && self.code == exit_code::USAGE {
            self.code = exit_code::FAILURE;
        }
        self
    }

    /// Creates a failure with the exit code of wrong usage.
    pub fn usage(sentence: impl fmt::Display) -> Self {
        Self::new(exit_code::USAGE, sentence)
    }
}

impl From<channel::Error> for Failure {
    fn from(error: channel::Error) -> Self {
        let code = match error {
            channel::Error::RoleTaken { .. } => exit_code::ALREADY_RUNNING,
            _ => exit_code::FAILURE,
        };
        Self::new(code, error)
    }
}

impl From<crate::ConfigError> for Failure {
    /// General failure of a service that cannot read a file, whose disk may be mounted later.
    fn from(error: crate::ConfigError) -> Self {
        match error {
            crate::ConfigError::Unreadable { .. } if is_service() => Self::general(error),
            _ => Self::usage(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_usage_is_final_only_before_the_first_readiness() {
        let code = |failure: Failure, was_ready| failure.after_readiness(was_ready).code;
        assert_eq!(code(Failure::usage("x"), false), exit_code::USAGE);
        assert_eq!(code(Failure::usage("x"), true), exit_code::FAILURE);
        let taken = Failure::new(exit_code::ALREADY_RUNNING, "x");
        assert_eq!(code(taken, true), exit_code::ALREADY_RUNNING);
    }
}
