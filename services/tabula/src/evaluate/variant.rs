//! The ways to describe and learn objects that experiments compare.

mod appearance;
mod good;
mod nearest_view;
mod settings;

use super::object_views::{Catalogue, ViewTable};
use crate::arguments::{DescriptionArguments, Variant};
use crate::output::Output;
use evaluation::recogniser::Recogniser;
use service::Failure;
pub(super) use settings::DescriptionSettings;

/// Views that are described and ready to be learned.
pub(super) trait Learner: Sync {
    /// A recogniser that was taught nothing.
    fn recogniser(&self) -> Box<dyn Recogniser + '_>;
}

/// All readings of a view: the first is stored when it is taught, all are compared
/// with what is stored when it is asked.
type Readings = Vec<Vec<f32>>;

/// Reads and describes the views that the arguments choose.
pub(super) fn described(
    arguments: &DescriptionArguments,
    output: &Output,
) -> Result<(ViewTable, Box<dyn Learner>), Failure> {
    let catalogue = Catalogue::open(arguments)?;
    let (table, descriptors) = match arguments.variant {
        Variant::Published | Variant::Workspace => good::describe(arguments, &catalogue, output),
        Variant::Ours => appearance::describe(arguments, &catalogue, output),
    }?;
    let learner = nearest_view::NearestView::new(arguments, &table, descriptors);
    Ok((table, Box::new(learner.map_err(super::failed)?)))
}
