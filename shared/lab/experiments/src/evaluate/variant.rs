//! The ways to describe and learn objects that experiments compare.

mod describer;
mod method;
mod nearest_view;
mod settings;

use super::object_views::{Catalogue, ViewTable};
use crate::arguments::DescriptionArguments;
use command_line::Output;
use evaluation::recogniser::Recogniser;
use service::Failure;
use std::path::Path;

pub(super) use describer::Describer;
pub(super) use method::Method;
pub(super) use settings::DescriptionSettings;

/// Views that are described and ready to be learned.
pub(super) trait Learner: Sync {
    /// A recogniser that was taught nothing.
    fn recogniser(&self) -> Box<dyn Recogniser + '_>;
}

/// All readings of a view: the first is stored when it is taught, all are compared
/// with what is stored when it is asked.
pub(super) type Readings = Vec<Vec<f32>>;

/// Reads and describes the views of a data set as the arguments say.
pub(super) fn described(
    dataset: &Path,
    arguments: &DescriptionArguments,
    output: &Output,
) -> Result<(ViewTable, Box<dyn Learner>), Failure> {
    let catalogue = Catalogue::open(dataset, arguments.views_max)?;
    let method = Method::of(arguments);
    let (table, mut descriptions) = catalogue.describe_by(&[method], output)?;
    let descriptions = descriptions.pop().unwrap_or_default();
    let learner = method.learner(&table, descriptions)?;
    Ok((table, learner))
}
