//! Occluded-table search: the table around an object whose top is the largest plane.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::footprint::Footprint;
use crate::plane_region::{
    PlaneRegionBuffers, RegionFilter, find_region, region_plane, region_polygon,
};
use crate::samples::{Samples, plane_band_m};
use crate::table::FLOOR_GAP_M;
use geometry::{ConvexPolygon, Plane};

/// Bin width of the height histogram under a plane, metres. Chosen; sensitivity: see
/// `tabula-lab sweep`.
const STEP_M: f64 = 0.008;

/// Number of histogram bins down to the floor gap.
const N_STEPS: usize = (FLOOR_GAP_M / STEP_M) as usize;

/// Greatest overhang of an object's top over the visible table, metres. Chosen;
/// sensitivity: see `tabula-lab sweep`.
const OVERHANG_M: f64 = 0.02;

/// Buffers of the occluded-table search.
#[derive(Debug, Default)]
pub(crate) struct OccludedTableBuffers {
    top: ConvexPolygon,
    table: ConvexPolygon,
}

/// Plane of the table under an object whose top is `plane`: a parallel plane a little lower
/// that is visible on all sides of it. `None` when the plane is too large for an object's
/// top or no such table exists.
pub(crate) fn find_occluded_table(
    samples: &Samples,
    plane: &Plane,
    config: &RawConfig,
    n_min: usize,
    region: &mut PlaneRegionBuffers,
    buffers: &mut OccludedTableBuffers,
) -> Option<Plane> {
    let OccludedTableBuffers { top, table } = buffers;
    let gap_m = most_frequent_gap_m(samples, plane, config, n_min)?;
    // One frame for both polygons, so that they are comparable.
    let plane_from_camera = plane.plane_from_source();
    find_region(
        samples,
        plane,
        &plane_from_camera,
        RegionFilter::WideOnly,
        region,
    );
    region_polygon(samples, region, top);
    if longest_side_m(top)? > config.side_max_m {
        return None;
    }
    let mut lower = *plane;
    lower.offset_m += gap_m;
    let n_around = find_region(
        samples,
        &lower,
        &plane_from_camera,
        RegionFilter::All,
        region,
    );
    region_polygon(samples, region, table);
    let is_around = |corner| table.signed_distance_m(corner) >= -OVERHANG_M;
    let surrounds = n_around >= n_min && top.corners().iter().all(is_around);
    surrounds.then(|| region_plane(samples, region).unwrap_or(lower))
}

/// Mode of the height histogram under a plane, metres below it; `None` when it holds fewer
/// than `n_min` samples.
fn most_frequent_gap_m(
    samples: &Samples,
    plane: &Plane,
    config: &RawConfig,
    n_min: usize,
) -> Option<f64> {
    let height = AffineForm::from(plane);
    let mut counts = [0_usize; N_STEPS];
    for sample in (0..samples.len()).filter(|&sample| samples.is_unassigned(sample)) {
        let below = -samples.coordinate(&height, sample);
        if below > 2.0 * plane_band_m(samples.depth(sample), config) {
            let step = (f64::from(below) / STEP_M) as usize;
            counts
                .get_mut(step)
                .into_iter()
                .for_each(|count| *count += 1);
        }
    }
    let pairs = counts.windows(2).map(|pair| pair[0] + pair[1]);
    let (step, n) = pairs.enumerate().max_by_key(|&(_, n)| n)?;
    (n >= n_min).then_some((step + 1) as f64 * STEP_M)
}

/// Longer side of the minimum-area rectangle around a polygon, metres; `None` without
/// corners.
fn longest_side_m(polygon: &ConvexPolygon) -> Option<f64> {
    let mut footprint = Footprint::new();
    for corner in polygon.corners() {
        footprint.add(corner.x as f32, corner.y as f32);
    }
    let rectangle = footprint.min_area_rectangle()?;
    Some(2.0 * rectangle.half_sides_m.x)
}
