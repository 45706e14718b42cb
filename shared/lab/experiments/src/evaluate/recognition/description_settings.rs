//! Settings of description and comparison, as part of a report.

use crate::arguments::{DescriptionArguments, DescriptorVariant, UpAxis};
use clap::ValueEnum;
use serde::Serialize;

/// Settings of description and comparison.
#[derive(Debug, Serialize)]
pub(in super::super) struct DescriptionSettings {
    pub(in super::super) variant: &'static str,
    pub(in super::super) distance: String,
    /// Bins of GOOD along each side; null for other descriptors.
    pub(in super::super) bins: Option<usize>,
    shape_only: bool,
    /// Upward axis given on the command line.
    up: Option<String>,
    threshold: Option<f32>,
    views_max: Option<u32>,
}

impl DescriptionSettings {
    pub(in super::super) fn of(arguments: &DescriptionArguments) -> Self {
        let is_good = arguments.variant != DescriptorVariant::Ours;
        let name = |up: UpAxis| Some(up.to_possible_value()?.get_name().to_owned());
        Self {
            variant: arguments.variant.word(),
            distance: arguments.metric().to_string(),
            bins: is_good.then_some(arguments.bins),
            shape_only: is_good || arguments.shape_only,
            up: arguments.up.and_then(name),
            threshold: arguments.threshold,
            views_max: arguments.views_max,
        }
    }

    /// Text for the report: `GOOD with 15 bins (published), half-chi-squared-root`.
    pub(in super::super) fn text(&self) -> String {
        let what = match self.bins {
            Some(bins) => format!("{} GOOD with {bins} bins", self.variant),
            None if self.shape_only => format!("{}, shape and size", self.variant),
            None => format!("{}, shape, size and colour", self.variant),
        };
        format!("{what}, distance {}", self.distance)
    }
}
