//! Swept parameters and the operating points of a sweep.

use crate::arguments::SourceArguments;
use clap::ValueEnum;
use service::{Failure, exit_code};
use std::ops::RangeInclusive;

/// Parameter of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Axis {
    /// Number of objects, 1 to 64, on a computed table
    Objects,
    /// Points of each of six simulated cubes; values are their sides, millimetres
    Points,
    /// Number of stored views, 10 to 100000
    Views,
    /// Frames per second, 5 to 120, until the daemon does not sustain the rate
    Rate,
    /// Number of cores for daemon and source, 1 and 2
    Cores,
}

/// Operating point of a sweep: the conditions of one measurement.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    /// Value of the swept parameter.
    pub(crate) value: f64,
    /// Frame source.
    pub(crate) source: SourceArguments,
    /// Number of views taught beforehand.
    pub(crate) n_views: usize,
    /// Side of the boxes of a generated scene, metres; `None` for other sources.
    pub(crate) box_side_m: Option<f64>,
    /// Number of cores for the daemon; `None` for all.
    pub(crate) n_cores: Option<usize>,
}

/// Operating point with a cheap source, so that the daemon dominates the measurement.
fn crowd(n_objects: u32) -> Place {
    Place {
        value: f64::from(n_objects),
        source: SourceArguments::of(&format!("crowd:{n_objects}")),
        n_views: 0,
        box_side_m: None,
        n_cores: None,
    }
}

/// Number of objects in sweeps of other parameters.
const N_OBJECTS: u32 = 10;

impl Axis {
    /// Word on the command line and in file names.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Objects => "objects",
            Self::Points => "points",
            Self::Views => "views",
            Self::Rate => "rate",
            Self::Cores => "cores",
        }
    }

    /// Axis label.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Objects => "objects",
            Self::Points => "points per object",
            Self::Views => "stored views",
            Self::Rate => "frames per second",
            Self::Cores => "cores",
        }
    }

    /// Default values of the sweep, ascending.
    fn usual_values(self) -> &'static [u32] {
        match self {
            Self::Objects => &[1, 2, 4, 8, 16, 32, 64],
            Self::Points => &[30, 50, 80, 120, 160],
            Self::Views => &[10, 100, 1000, 10_000, 100_000],
            Self::Rate => &[5, 10, 15, 30, 45, 60, 90, 120],
            Self::Cores => &[1, 2],
        }
    }

    /// Permitted values.
    fn possible_values(self) -> RangeInclusive<u32> {
        match self {
            Self::Objects => 1..=256,
            Self::Points => 20..=180,
            Self::Views => 1..=1_000_000,
            Self::Rate => 1..=1000,
            Self::Cores => 1..=1024,
        }
    }

    /// Operating points of the given values, or of the default values if none are given.
    ///
    /// # Errors
    /// If a value is not permitted.
    pub(crate) fn places(self, values: &[u32]) -> Result<Vec<Place>, Failure> {
        let possible = self.possible_values();
        if let Some(value) = values.iter().find(|value| !possible.contains(value)) {
            let (least, most) = (possible.start(), possible.end());
            return Err(Failure::new(
                exit_code::USAGE,
                format!(
                    "a value of {} is from {least} to {most}, not {value}",
                    self.word()
                ),
            ));
        }
        let values = if values.is_empty() {
            self.usual_values()
        } else {
            values
        };
        Ok(values.iter().map(|value| self.place(*value)).collect())
    }

    fn place(self, value: u32) -> Place {
        let mut place = crowd(N_OBJECTS);
        place.value = f64::from(value);
        match self {
            Self::Objects => place = crowd(value),
            Self::Points => place.box_side_m = Some(f64::from(value) / 1000.0),
            Self::Views => place.n_views = value as usize,
            Self::Rate => place.source.rate = Some(f64::from(value)),
            Self::Cores => place.n_cores = Some(value as usize),
        }
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_values_are_possible_ones() {
        for axis in Axis::value_variants() {
            let places = axis.places(&[]).unwrap();
            assert_eq!(places.len(), axis.usual_values().len());
            assert!(axis.places(axis.usual_values()).is_ok());
        }
    }

    #[test]
    fn an_impossible_value_is_refused_with_its_rule() {
        let refused = Axis::Objects.places(&[4, 0]).unwrap_err();
        assert!(refused.sentence.contains("from 1 to 256, not 0"));
        let chosen = Axis::Rate.places(&[60]).unwrap();
        assert_eq!(chosen[0].source.rate, Some(60.0));
    }
}
