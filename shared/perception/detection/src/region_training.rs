//! Training examples of region merging.

use crate::Config;
use crate::input::DetectionInput;
use crate::organized::list_region_pairs;
use crate::region_merging::RegionPair;
use crate::workspace::Workspace;

/// List the pairs of adjacent regions in an organised cloud with known objects, with the
/// decision that is right, in `pairs`.
///
/// `objects` holds the object of each point; `None` where there is none, or it is unknown.
/// Regions that several objects share are left out.
pub fn region_pairs(
    frame: &DetectionInput<'_>,
    config: &Config,
    workspace: &mut Workspace,
    objects: &[Option<u16>],
    pairs: &mut Vec<RegionPair>,
) {
    let object_of = |pixel: u32| objects.get(pixel as usize).copied().flatten();
    list_region_pairs(frame, config, &mut workspace.organized, object_of, pairs);
}
