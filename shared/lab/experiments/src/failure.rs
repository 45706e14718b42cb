//! Constructors of command-line failures: general failure and wrong usage.

use service::{Failure, exit_code};
use std::fmt::Display;

/// Failure with the general exit code.
pub(crate) fn failed(error: impl Display) -> Failure {
    Failure::new(exit_code::FAILURE, error)
}

/// Failure with the exit code of wrong usage.
pub(crate) fn usage(error: impl Display) -> Failure {
    Failure::new(exit_code::USAGE, error)
}
