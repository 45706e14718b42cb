//! What can go wrong with a measurement or a setting.

use std::fmt;

/// Why a measurement or a setting was refused.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A number of the measurement can not belong to an object.
    ImpossibleMeasurement {
        /// Which one, and what it must be.
        rule: &'static str,
    },
    /// The measurement was captured before the one the track saw last.
    OutOfOrder {
        /// Capture stamp of the measurement.
        stamp_ns: u64,
        /// Capture stamp of the track's state.
        state_stamp_ns: u64,
    },
    /// A setting lies outside its range.
    InvalidSetting {
        /// Name of the setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Least allowed value.
        min: f64,
        /// Greatest allowed value.
        max: f64,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ImpossibleMeasurement { rule } => {
                write!(
                    f,
                    "the measurement can not be that of an object: {rule}; ignore it"
                )
            }
            Self::OutOfOrder {
                stamp_ns,
                state_stamp_ns,
            } => write!(
                f,
                "the measurement of {stamp_ns} ns is older than the track's state of \
                 {state_stamp_ns} ns; give each track its frames in the order of capture"
            ),
            Self::InvalidSetting {
                name,
                value,
                min,
                max,
            } => write!(
                f,
                "the tracking setting {name} is {value} but must lie between {min} and {max}"
            ),
        }
    }
}

impl std::error::Error for Error {}

/// Checks that settings lie in their ranges; NaN lies in none.
pub(crate) fn check_settings(settings: &[(&'static str, f64, f64, f64)]) -> Result<(), Error> {
    for &(name, value, min, max) in settings {
        if !(min..=max).contains(&value) {
            return Err(Error::InvalidSetting {
                name,
                value,
                min,
                max,
            });
        }
    }
    Ok(())
}
