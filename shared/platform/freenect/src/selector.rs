//! Selector of one of several Kinects by index or serial number.

use std::fmt;

/// Selector of one of several Kinects.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Selector {
    /// Index on the bus, from 0; may change when devices are replugged.
    Index(u32),
    /// Selects by the permanent serial number of the camera.
    Serial(String),
}

impl fmt::Display for Selector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => write!(f, "index {index}"),
            Self::Serial(serial) => write!(f, "serial {serial}"),
        }
    }
}
