//! Recognition methods: descriptor, classifier and settings of an experiment.

mod description_settings;
mod descriptor_choice;
mod nearest_view;
mod recognition_method;
mod view_describer;

use evaluation::recogniser::Recogniser;

pub(super) use description_settings::DescriptionSettings;
pub(super) use recognition_method::RecognitionMethod;
pub(super) use view_describer::ViewDescriber;

/// Factory of untrained recognisers over described views.
pub(super) trait RecogniserFactory: Sync {
    /// Creates a recogniser without any taught view.
    fn recogniser(&self) -> Box<dyn Recogniser + '_>;
}

/// Descriptors of all axis hypotheses of a view: teaching stores the first, a query compares all.
pub(super) type HypothesisDescriptors = Vec<Vec<f32>>;
