//! A way to describe and compare objects, by what an experiment needs to know of it.

use super::describer::Describer;
use super::nearest_view::NearestView;
use super::{Learner, Readings};
use crate::arguments::{AblationVariant, DescriptionArguments, Up, Variant};
use crate::evaluate::failed;
use description::{AppearanceWeights, GoodVariant, N_READINGS, Support};
use learning::Metric;
use service::Failure;

/// Points nearer to the middle have no say in the signs of published GOOD, metres.
const SIGN_THRESHOLD_M: f32 = 0.0015;

/// What is described of an object, and how descriptions are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Method {
    pub(super) kind: Kind,
    metric: Metric,
    /// Infinite when nothing is unknown.
    threshold: f32,
}

/// Which descriptor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// GOOD in the frame of its published program.
    Good { variant: GoodVariant, n_bins: usize },
    /// Our own.
    Appearance {
        weights: AppearanceWeights,
        /// How many readings of an object are compared with what is stored.
        n_readings: usize,
        /// What is up, if it is not as the data tell.
        up: Option<Up>,
    },
}

impl Method {
    /// What the command line asks for.
    pub(in super::super) fn of(arguments: &DescriptionArguments) -> Self {
        let weights = if arguments.shape_only {
            AppearanceWeights::shape_only()
        } else {
            AppearanceWeights::default()
        };
        Self {
            kind: match arguments.variant {
                Variant::Published => published(arguments.bins),
                Variant::Workspace => workspace(arguments.bins),
                Variant::Ours => Kind::Appearance {
                    weights,
                    n_readings: N_READINGS,
                    up: arguments.up,
                },
            },
            metric: arguments.metric(),
            threshold: arguments.threshold.unwrap_or(f32::INFINITY),
        }
    }

    /// One of those that an ablation compares.
    pub(in super::super) fn of_ablation(variant: AblationVariant, n_bins: usize) -> Self {
        let all = AppearanceWeights::default();
        let (kind, metric) = match variant {
            AblationVariant::Published => (published(n_bins), Metric::HalfChiSquaredRoot),
            AblationVariant::Workspace => (workspace(n_bins), Metric::Manhattan),
            ours => {
                let weights = match ours {
                    AblationVariant::OursShapeOnly => AppearanceWeights::shape_only(),
                    AblationVariant::OursNoSize => AppearanceWeights { size: 0.0, ..all },
                    AblationVariant::OursNoShape => AppearanceWeights { shape: 0.0, ..all },
                    AblationVariant::OursProjectionsOnly => AppearanceWeights {
                        size: 0.0,
                        color: 0.0,
                        ..all
                    },
                    _ => all,
                };
                let kind = Kind::Appearance {
                    weights,
                    n_readings: match ours {
                        AblationVariant::OursSingleReading => 1,
                        _ => N_READINGS,
                    },
                    up: (ours == AblationVariant::OursPrincipal).then_some(Up::Unknown),
                };
                (kind, Metric::Euclidean)
            }
        };
        Self {
            kind,
            metric,
            threshold: f32::INFINITY,
        }
    }

    /// What describes views.
    pub(in super::super) fn describer(&self) -> Result<Describer, Failure> {
        Describer::new(self)
    }

    /// What learns views of `n_categories` categories by their descriptions.
    pub(in super::super) fn learner(
        &self,
        n_categories: usize,
        descriptions: Vec<Readings>,
    ) -> Result<Box<dyn Learner>, Failure> {
        let learner = NearestView::new(self.metric, self.threshold, n_categories, descriptions);
        Ok(Box::new(learner.map_err(failed)?))
    }
}

fn published(n_bins: usize) -> Kind {
    Kind::Good {
        variant: GoodVariant::Published {
            sign_threshold_m: SIGN_THRESHOLD_M,
        },
        n_bins,
    }
}

fn workspace(n_bins: usize) -> Kind {
    Kind::Good {
        variant: GoodVariant::Workspace {
            support: Support::Adaptive,
        },
        n_bins,
    }
}
