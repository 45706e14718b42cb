//! Detection in unorganised clouds: one row or one column of points.
//!
//! A cloud that is a single view from its origin along z, for example an organised cloud
//! without its empty pixels and its order, is reprojected onto an image grid and takes the
//! image path. Any other cloud, for example one merged from several views or in the world
//! frame, takes the voxel path: planes are searched on voxel centroids, clusters are
//! connected cells above the table, and large clusters are split in a depth image from a
//! virtual viewpoint.

mod label_groups;
mod pixel_lattice;
mod point_labels;
mod resampling;
mod single_view;
mod table_coverage;
mod view_extent;
mod virtual_view;
mod voxel_centroids;
mod voxel_clusters;
mod voxel_detection;
mod voxel_grid;
mod voxel_table;

use self::point_labels::PointLabels;
use self::single_view::{SingleView, ViewEvidence};
use self::voxel_detection::VoxelDetector;
use crate::Config;
use crate::execution::Execution;
use crate::input::DetectionInput;
use crate::organized::{OrganizedBuffers, detect_organized};
use crate::output::Detection;
use point_cloud::OrganizedCloud;

/// Buffers of the unorganised path.
#[derive(Debug, Default)]
pub(crate) struct UnorganizedBuffers {
    view: SingleView,
    labels: PointLabels,
    voxel_detector: VoxelDetector,
}

/// `true` when a cloud has no image grid.
pub(crate) fn is_unorganized(cloud: &OrganizedCloud<'_>) -> bool {
    cloud.width() == 1 || cloud.height() == 1
}

/// Detect in an unorganised cloud; `detection` comes empty.
pub(crate) fn detect_unorganized(
    frame: &DetectionInput<'_>,
    config: &Config,
    buffers: &mut UnorganizedBuffers,
    organized: &mut OrganizedBuffers,
    detection: &mut Detection,
) {
    let evidence = buffers.view.reproject(frame.cloud.points());
    match evidence {
        Some(ViewEvidence::Lattice) => {
            detect_in_single_view(frame, config, buffers, organized, detection);
        }
        Some(ViewEvidence::UniformDensity) => {
            let config = config.without_joined_parts();
            detect_in_single_view(frame, &config, buffers, organized, detection);
        }
        None => {}
    }
    // Uniform density alone does not prove a view: a table in the world frame, seen from
    // below, is uniformly dense too.
    let is_view = evidence == Some(ViewEvidence::Lattice) || !detection.candidates.is_empty();
    if !is_view {
        detection.surfaces.clear();
        let detector = &mut buffers.voxel_detector;
        detector.detect(frame, config, organized, detection);
    }
}

/// Detect in the image of a single view and transfer the result to the points.
fn detect_in_single_view(
    frame: &DetectionInput<'_>,
    config: &Config,
    buffers: &mut UnorganizedBuffers,
    organized: &mut OrganizedBuffers,
    detection: &mut Detection,
) {
    let UnorganizedBuffers { view, labels, .. } = buffers;
    let Some(image) = view.image() else { return };
    let image_frame = DetectionInput {
        cloud: image,
        ..*frame
    };
    detect_organized(
        &image_frame,
        config,
        organized,
        detection,
        Execution::default(),
    );
    let points = frame.cloud.points();
    labels.refill(detection, image.points().len(), points.len(), |i| {
        view.surface_pixel(i, &points[i])
    });
    labels.write_indices(detection);
}
