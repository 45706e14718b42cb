//! What can be swept, and over which places.

use crate::arguments::SourceArguments;
use clap::ValueEnum;
use service::{Failure, exit_code};
use std::ops::RangeInclusive;

/// An axis of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Axis {
    /// Number of objects, 1 to 64, on a computed table
    Objects,
    /// Points of each of six simulated cubes; values are their sides, millimetres
    Points,
    /// Views that were taught, 10 to 100000
    Views,
    /// Frames per second, 5 to 120, until the daemon does not hold the rate
    Rate,
    /// Cores for daemon and source, 1 and 2
    Cores,
}

/// What is measured at one place.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    /// Place on the axis.
    pub(crate) value: f64,
    /// Where the frames come from.
    pub(crate) source: SourceArguments,
    /// Views that are taught beforehand.
    pub(crate) n_views: usize,
    /// Side of the boxes, metres, where the source is to be made of them.
    pub(crate) box_side_m: Option<f64>,
    /// Cores for the daemon; all without.
    pub(crate) n_cores: Option<usize>,
}

/// A source that costs little: what is measured is the daemon.
fn crowd(n_objects: u32) -> Place {
    Place {
        value: f64::from(n_objects),
        source: SourceArguments::of(&format!("crowd:{n_objects}")),
        n_views: 0,
        box_side_m: None,
        n_cores: None,
    }
}

/// Objects of the sweeps over other things.
const N_OBJECTS: u32 = 10;

impl Axis {
    /// The word on the command line and in file names.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Objects => "objects",
            Self::Points => "points",
            Self::Views => "views",
            Self::Rate => "rate",
            Self::Cores => "cores",
        }
    }

    /// What it shows.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Objects => "objects",
            Self::Points => "points per object",
            Self::Views => "stored views",
            Self::Rate => "frames per second",
            Self::Cores => "cores",
        }
    }

    /// The values that are measured when none are named, in order.
    fn usual_values(self) -> &'static [u32] {
        match self {
            Self::Objects => &[1, 2, 4, 8, 16, 32, 64],
            Self::Points => &[30, 50, 80, 120, 160],
            Self::Views => &[10, 100, 1000, 10_000, 100_000],
            Self::Rate => &[5, 10, 15, 30, 45, 60, 90, 120],
            Self::Cores => &[1, 2],
        }
    }

    /// The values that can be measured.
    fn possible_values(self) -> RangeInclusive<u32> {
        match self {
            Self::Objects => 1..=256,
            Self::Points => 20..=180,
            Self::Views => 1..=1_000_000,
            Self::Rate => 1..=1000,
            Self::Cores => 1..=1024,
        }
    }

    /// The places of these values, or of the usual ones.
    ///
    /// # Errors
    /// When a value can not be measured.
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
