//! Our own descriptor.

use super::super::failed;
use super::super::object_views::{Catalogue, ViewTable};
use super::Readings;
use crate::arguments::{DescriptionArguments, Up};
use crate::output::Output;
use dataset::object_views::ObjectView;
use description::{Appearance, AppearanceWeights, Error, ObjectPoints};
use service::Failure;

/// Describes all views, upright where what is up is known of all of them.
pub(super) fn describe(
    arguments: &DescriptionArguments,
    catalogue: &Catalogue,
    output: &Output,
) -> Result<(ViewTable, Vec<Readings>), Failure> {
    let weights = if arguments.shape_only {
        AppearanceWeights::shape_only()
    } else {
        AppearanceWeights::default()
    };
    let appearance = Appearance::new(weights).map_err(failed)?;
    let told = arguments.up.map(Up::direction);
    let is_told_by_all = catalogue.tell_up();
    let describe = |appearance: &mut Appearance, view: &ObjectView| {
        let up = match told {
            Some(up) => up,
            None => view.up.filter(|_| is_told_by_all),
        };
        let readings = appearance.describe(ObjectPoints::all(&view.points), up.as_ref())?;
        Ok::<_, Error>(readings.to_vec())
    };
    catalogue.describe(output, || appearance.clone(), describe)
}
