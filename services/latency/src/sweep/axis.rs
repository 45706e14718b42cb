//! What can be swept, and over which places.

use crate::arguments::SourceArguments;
use clap::ValueEnum;

/// An axis of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Axis {
    /// Number of objects, 1 to 64, on a computed table
    Objects,
    /// Points of each of six simulated boxes, by their size
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
fn crowd(n_objects: usize) -> Place {
    Place {
        value: n_objects as f64,
        source: SourceArguments::of(&format!("crowd:{n_objects}")),
        n_views: 0,
        box_side_m: None,
        n_cores: None,
    }
}

/// Objects of the sweeps over other things.
const N_OBJECTS: usize = 10;

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

    /// Its places, in order.
    pub(crate) fn places(self) -> Vec<Place> {
        match self {
            Self::Objects => [1, 2, 4, 8, 16, 32, 64].map(crowd).into(),
            Self::Points => [0.03, 0.05, 0.08, 0.12, 0.16].map(boxes).into(),
            Self::Views => [10, 100, 1000, 10_000, 100_000].map(taught).into(),
            Self::Rate => [5, 10, 15, 30, 45, 60, 90, 120].map(at_rate).into(),
            Self::Cores => [1, 2].map(on_cores).into(),
        }
    }
}

fn boxes(side_m: f64) -> Place {
    Place {
        value: side_m,
        box_side_m: Some(side_m),
        ..crowd(0)
    }
}

fn taught(n_views: usize) -> Place {
    Place {
        value: n_views as f64,
        n_views,
        ..crowd(N_OBJECTS)
    }
}

fn at_rate(rate_hz: u32) -> Place {
    let mut place = crowd(N_OBJECTS);
    place.value = f64::from(rate_hz);
    place.source.rate = Some(f64::from(rate_hz));
    place
}

fn on_cores(n_cores: usize) -> Place {
    Place {
        value: n_cores as f64,
        n_cores: Some(n_cores),
        ..crowd(N_OBJECTS)
    }
}
