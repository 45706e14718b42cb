//! Parameters that a latency sweep can vary.

use clap::ValueEnum;
use std::ops::RangeInclusive;

coded_enum::coded_enum! {
    /// Swept parameter of a latency sweep.
    #[derive(ValueEnum)]
    pub(crate) enum SweepAxis {
        /// Number of objects, 1 to 64, on a computed table
        Objects, "objects";
        /// Points per object: six simulated cubes; values are their sides, millimetres
        Points, "points";
        /// Number of stored views, 10 to 100000
        Views, "views";
        /// Frames per second, 5 to 120, until the daemon does not sustain the rate
        Rate, "rate";
        /// Number of cores for daemon and source, 1 and 2
        Cores, "cores";
    }
}

impl SweepAxis {
    /// Axis label of the sweep diagram.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Objects => "objects",
            Self::Points => "points per object",
            Self::Views => "stored views",
            Self::Rate => "frames per second",
            Self::Cores => "cores",
        }
    }

    /// Default values of the swept parameter, ascending.
    pub(crate) fn default_values(self) -> &'static [u32] {
        match self {
            Self::Objects => &[1, 2, 4, 8, 16, 32, 64],
            Self::Points => &[30, 50, 80, 120, 160],
            Self::Views => &[10, 100, 1000, 10_000, 100_000],
            Self::Rate => &[5, 10, 15, 30, 45, 60, 90, 120],
            Self::Cores => &[1, 2],
        }
    }

    /// Permitted values of the swept parameter.
    pub(crate) fn permitted_values(self) -> RangeInclusive<u32> {
        match self {
            Self::Objects => 1..=256,
            Self::Points => 20..=180,
            Self::Views => 1..=1_000_000,
            Self::Rate => 1..=1000,
            Self::Cores => 1..=1024,
        }
    }
}
