//! GOOD in the frame of its published program.

use super::super::object_views::{Catalogue, ViewTable};
use super::Readings;
use crate::arguments::{DescriptionArguments, Variant};
use crate::output::Output;
use dataset::object_views::ObjectView;
use description::{Descriptor, Error, Good, GoodVariant, ObjectPoints, Support, reference_frame};
use service::{Failure, exit_code};

/// Points nearer to the middle have no say in the signs of published GOOD, metres.
const SIGN_THRESHOLD_M: f32 = 0.0015;

/// Describes all views, published or as in the authors' evaluations.
pub(super) fn describe(
    arguments: &DescriptionArguments,
    catalogue: &Catalogue,
    output: &Output,
) -> Result<(ViewTable, Vec<Readings>), Failure> {
    let variant = match arguments.variant {
        Variant::Workspace => GoodVariant::Workspace {
            support: Support::Adaptive,
        },
        Variant::Published | Variant::Ours => GoodVariant::Published {
            sign_threshold_m: SIGN_THRESHOLD_M,
        },
    };
    let good = Good::new(arguments.bins, variant)
        .map_err(|error| Failure::new(exit_code::USAGE, error))?;
    let describe = |good: &mut Good, view: &ObjectView| {
        let points = ObjectPoints::all(&view.points);
        let frame = reference_frame(points).ok_or(Error::NoPoints)?;
        let mut descriptor = Vec::new();
        good.compute(points, &frame, &mut descriptor)?;
        Ok::<_, Error>(vec![descriptor])
    };
    catalogue.describe(output, || good.clone(), describe)
}
