//! A way to describe and compare objects, by what an experiment needs to know of it.

use super::describer::Describer;
use super::nearest_view::NearestView;
use super::{Learner, Readings};
use crate::arguments::{AblationVariant, DescriptionArguments, Up, Variant};
use crate::evaluate::failed;
use crate::evaluate::object_views::ViewTable;
use description::{AppearanceWeights, AxesKind, GoodVariant, N_AXIS_HYPOTHESES, Support};
use learning::{Calibration, CategoryIndex, Metric};
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
                    n_readings: N_AXIS_HYPOTHESES,
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
                        _ => N_AXIS_HYPOTHESES,
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

    /// What learns views by their descriptions, which are in the order of the table.
    pub(in super::super) fn learner(
        &self,
        views: &ViewTable,
        descriptions: Vec<Readings>,
    ) -> Result<Box<dyn Learner>, Failure> {
        let dimension = descriptions.first().map_or(0, |readings| readings[0].len());
        let index = CategoryIndex::new(dimension, self.metric);
        let index = match self.calibration(views.tells_up) {
            Some(calibration) => index.with_calibration(calibration),
            None => index,
        };
        let n_categories = views.categories.len();
        let learner = NearestView::new(index, self.threshold, n_categories, descriptions);
        Ok(Box::new(learner.map_err(failed)?))
    }

    /// As in the live system, where all readings are compared in its metric.
    fn calibration(&self, data_tell_up: bool) -> Option<Calibration> {
        let Kind::Appearance { n_readings, up, .. } = self.kind else {
            return None;
        };
        let is_upright = up.map_or(data_tell_up, |up| up != Up::Unknown);
        let kind = if is_upright {
            AxesKind::Upright
        } else {
            AxesKind::Principal
        };
        let is_live = n_readings == N_AXIS_HYPOTHESES && self.metric == Metric::Euclidean;
        is_live.then(|| pipeline::calibration(kind))
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
