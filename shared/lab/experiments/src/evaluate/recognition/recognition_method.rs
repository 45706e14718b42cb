//! Recognition method: descriptor, metric and rejection threshold.

use super::descriptor_choice::DescriptorChoice;
use super::nearest_view::NearestViewClassifier;
use super::view_describer::ViewDescriber;
use super::{HypothesisDescriptors, RecogniserFactory};
use crate::arguments::{AblationVariant, DescriptionArguments, DescriptorVariant, UpAxis};
use crate::evaluate::view_table::ViewTable;
use description::{AppearanceWeights, AxesKind, N_AXIS_HYPOTHESES};
use learning::{Calibration, CategoryIndex, Metric};
use service::Failure;

/// Descriptor, metric and rejection threshold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct RecognitionMethod {
    descriptor: DescriptorChoice,
    metric: Metric,
    /// Distance above which an object is unknown; infinite for none.
    threshold: f32,
    /// `true` if the nearest view decides in place of the local ridge regression.
    is_nearest_view: bool,
}

impl RecognitionMethod {
    /// Recognition method of the command-line options.
    pub(in super::super) fn of(arguments: &DescriptionArguments) -> Self {
        let weights = if arguments.shape_only {
            AppearanceWeights::shape_only()
        } else {
            AppearanceWeights::default()
        };
        Self {
            descriptor: match arguments.variant {
                DescriptorVariant::Published => DescriptorChoice::published_good(arguments.bins),
                DescriptorVariant::Workspace => DescriptorChoice::workspace_good(arguments.bins),
                DescriptorVariant::Ours => DescriptorChoice::Appearance {
                    weights,
                    n_hypotheses: N_AXIS_HYPOTHESES,
                    up: arguments.up,
                },
            },
            metric: arguments.metric(),
            threshold: arguments.threshold.unwrap_or(f32::INFINITY),
            is_nearest_view: false,
        }
    }

    /// Recognition method of an ablation variant.
    pub(in super::super) fn of_ablation(variant: AblationVariant, n_bins: usize) -> Self {
        let all = AppearanceWeights::default();
        let (descriptor, metric) = match variant {
            AblationVariant::Published => (
                DescriptorChoice::published_good(n_bins),
                Metric::HalfChiSquaredRoot,
            ),
            AblationVariant::Workspace => {
                (DescriptorChoice::workspace_good(n_bins), Metric::Manhattan)
            }
            ours => {
                let weights = match ours {
                    AblationVariant::OursShapeOnly => AppearanceWeights::shape_only(),
                    AblationVariant::OursNoSize => AppearanceWeights { size: 0.0, ..all },
                    AblationVariant::OursNoShape => AppearanceWeights { shape: 0.0, ..all },
                    AblationVariant::OursNoProfile => AppearanceWeights {
                        profile: 0.0,
                        ..all
                    },
                    AblationVariant::OursProjectionsOnly => AppearanceWeights {
                        size: 0.0,
                        color: 0.0,
                        profile: 0.0,
                        ..all
                    },
                    _ => all,
                };
                let descriptor = DescriptorChoice::Appearance {
                    weights,
                    n_hypotheses: match ours {
                        AblationVariant::OursSingleReading => 1,
                        _ => N_AXIS_HYPOTHESES,
                    },
                    up: (ours == AblationVariant::OursPrincipal).then_some(UpAxis::Unknown),
                };
                (descriptor, Metric::Euclidean)
            }
        };
        Self {
            descriptor,
            metric,
            threshold: f32::INFINITY,
            is_nearest_view: variant == AblationVariant::OursNearestView,
        }
    }

    /// Describer that the recognition method uses.
    pub(in super::super) fn describer(&self) -> Result<ViewDescriber, Failure> {
        ViewDescriber::new(&self.descriptor)
    }

    /// Factory of recognisers over the descriptors, which are in the order of the table.
    pub(in super::super) fn recogniser_factory(
        &self,
        views: &ViewTable,
        descriptions: Vec<HypothesisDescriptors>,
    ) -> Result<Box<dyn RecogniserFactory>, Failure> {
        let dimension = descriptions
            .first()
            .map_or(0, |descriptors| descriptors[0].len());
        let index = CategoryIndex::new(dimension, self.metric);
        let index = match self.calibration(views.is_up_known) {
            Some(calibration) => index.with_calibration(calibration),
            None => index,
        };
        let n_categories = views.categories.len();
        let factory = NearestViewClassifier::new(index, self.threshold, n_categories, descriptions);
        Ok(Box::new(factory.map_err(Failure::general)?))
    }

    /// Calibration of the live system; `None` unless all axis hypotheses are compared with its
    /// metric by its rule.
    fn calibration(&self, is_up_known: bool) -> Option<Calibration> {
        let DescriptorChoice::Appearance {
            n_hypotheses, up, ..
        } = self.descriptor
        else {
            return None;
        };
        let is_upright = up.map_or(is_up_known, |up| up != UpAxis::Unknown);
        let kind = if is_upright {
            AxesKind::Upright
        } else {
            AxesKind::Principal
        };
        let is_live = n_hypotheses == N_AXIS_HYPOTHESES && self.metric == Metric::Euclidean;
        (is_live && !self.is_nearest_view).then(|| pipeline::calibration(kind))
    }
}
