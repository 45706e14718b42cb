//! The ways to describe and learn objects that experiments compare.

mod description_settings;
mod descriptor_choice;
mod nearest_view;
mod recognition_method;
mod view_describer;

use evaluation::recogniser::Recogniser;

pub(super) use description_settings::DescriptionSettings;
pub(super) use recognition_method::RecognitionMethod;
pub(super) use view_describer::ViewDescriber;

/// Views that are described and ready to be learned.
pub(super) trait RecogniserFactory: Sync {
    /// A recogniser that was taught nothing.
    fn recogniser(&self) -> Box<dyn Recogniser + '_>;
}

/// All descriptors of a view: the first is stored when it is taught, all are compared
/// with what is stored when it is asked.
pub(super) type HypothesisDescriptors = Vec<Vec<f32>>;
