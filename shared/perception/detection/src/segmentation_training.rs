//! Training examples of the segmentation.

use crate::Config;
use crate::input::DetectionInput;
use crate::organized::add_segmentation_examples;
use crate::segmentation::SegmentationExamples;
use crate::workspace::Workspace;
use random::Random;

/// Add the edges and the pairs of adjacent regions in an organised cloud with known objects, with
/// the decisions that are right.
///
/// `objects` holds the object of each point; `None` where there is none, or it is unknown. Regions
/// that several objects share are left out. The regions of one object are merged step by step,
/// so that the examples hold merged regions too. Edges inside of objects are drawn from `random`.
pub fn add_examples(
    frame: &DetectionInput<'_>,
    config: &Config,
    workspace: &mut Workspace,
    objects: &[Option<u16>],
    random: &mut Random,
    examples: &mut SegmentationExamples,
) {
    let buffers = &mut workspace.organized;
    add_segmentation_examples(frame, config, buffers, objects, random, examples);
}
