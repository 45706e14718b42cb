//! Clouds without an image grid: one row or one column of points.
//!
//! A cloud that is one view from its origin along z, as an organised cloud is
//! that lost its empty pixels and its order, is laid back on an image grid and
//! searched there like any image. Any other cloud, such as one merged from
//! several views or turned into the frame of the world, takes the voxel path:
//! planes are searched on the centroids of voxels, clusters are connected cells
//! of the space over the table, and large ones are parted as they look from a
//! camera that is placed before them.

mod centroids;
mod groups;
mod labels;
mod lattice;
mod pile_view;
mod plane_region;
mod resampling;
mod single_view;
mod table_map;
mod view_extent;
mod voxel_clusters;
mod voxel_path;
mod voxel_planes;
mod voxel_table;
mod voxels;

use self::labels::Labels;
use self::single_view::{SingleView, Trust};
use self::voxel_path::VoxelPath;
use crate::Config;
use crate::detect::{Detection, Frame, Workspace, detect};
use point_cloud::OrganizedCloud;

/// A cloud with fewer usable points is no view.
const N_POINTS_MIN: usize = 64;

/// Mark of a point that is nowhere: in no pixel, voxel or cluster.
const NOWHERE: u32 = u32::MAX;

/// Buffers of clouds without a grid.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    view: SingleView,
    labels: Labels,
    path: VoxelPath,
}

/// Whether a cloud has no image grid.
pub(crate) fn has_no_grid(cloud: &OrganizedCloud<'_>) -> bool {
    cloud.width() == 1 || cloud.height() == 1
}

/// Searches a cloud without a grid; `detection` comes empty.
pub(crate) fn detect_unorganized(
    frame: &Frame<'_>,
    config: &Config,
    workspace: &mut Workspace,
    detection: &mut Detection,
) {
    // The organised search of an image needs the rest of the workspace.
    let mut buffers = workspace.unorganized.take().unwrap_or_default();
    let trust = buffers.view.lay(frame.cloud.points());
    if trust.is_some() {
        detect_in_view(frame, config, workspace, &mut buffers, detection);
    }
    // Evenly spread points may be no view at all: a table in the frame of the
    // world, say, seen from below.
    let is_view = trust == Some(Trust::Lattice) || !detection.candidates.is_empty();
    if !is_view {
        detection.table = None;
        let path = &mut buffers.path;
        path.detect(frame, config, workspace, detection);
    }
    workspace.unorganized = Some(buffers);
}

/// Searches the image of a single view and carries the result to the points.
fn detect_in_view(
    frame: &Frame<'_>,
    config: &Config,
    workspace: &mut Workspace,
    buffers: &mut Buffers,
    detection: &mut Detection,
) {
    let Buffers { view, labels, .. } = buffers;
    let Some(image) = view.image() else { return };
    let image_frame = Frame {
        cloud: image,
        ..*frame
    };
    if detect(&image_frame, config, workspace, detection).is_err() {
        return;
    }
    let points = frame.cloud.points();
    labels.refill(detection, image.points().len(), points.len(), |i| {
        view.surface_pixel(i, &points[i])
    });
    labels.hand_over(detection);
}
