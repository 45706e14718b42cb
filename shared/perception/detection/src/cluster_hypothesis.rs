//! Object hypothesis: a cluster with its statistics, box and support, before the
//! constraints are evaluated.

use crate::RawConfig;
use crate::affine_form::AffineForm;
use crate::candidate::Support;
use crate::pixel_bounds::PixelBounds;
use crate::upright_box::UprightBox;
use nalgebra::{Point3, Vector3};
use point_cloud::OrganizedCloud;

/// Least share of a cluster's points near the table for a standing object. Chosen.
const STANDING_SHARE: f64 = 0.005;

/// Greatest ratio of the lowest to the highest point of a standing round object, whose
/// contact area its own body occludes. Chosen.
const ROUND_GAP_SHARE: f32 = 0.2;

/// Greatest height of the lowest point of a standing round object over the table, metres.
/// Chosen.
const ROUND_GAP_MAX_M: f32 = 0.05;

/// Object hypothesis: a cluster with statistics, box and support.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ClusterHypothesis {
    pub(crate) cluster: u32,
    pub(crate) statistics: ClusterStatistics,
    pub(crate) upright_box: UprightBox,
    /// Support relation; `None` while no support is known.
    pub(crate) support: Option<Support>,
    /// `true` when the sensor has no depth below the lower border.
    pub(crate) is_base_without_depth: bool,
    /// Share of the lower border where it begins off the table, as furniture beside the table
    /// does; 0 for less than such furniture.
    pub(crate) off_table_share: f32,
    /// `true` when the longest side is in the range of objects.
    pub(crate) is_object_sized: bool,
    /// `true` for a cluster of masked points, which belong to a person or the robot.
    pub(crate) is_masked: bool,
}

impl ClusterHypothesis {
    /// Hypothesis of some points of a cloud with only the table as possible support; `None`
    /// without points.
    pub(crate) fn of(
        cluster: u32,
        indices: &[u32],
        cloud: &OrganizedCloud<'_>,
        table_axes: &[AffineForm; 3],
        config: &RawConfig,
    ) -> Option<Self> {
        if indices.is_empty() {
            return None;
        }
        let statistics = ClusterStatistics::of(indices, cloud, &table_axes[2], config);
        let [lowest_m, highest_m] = statistics.height_m.map(f64::from);
        let heights_m = [
            if statistics.is_standing {
                0.0
            } else {
                lowest_m
            },
            highest_m,
        ];
        let upright_box = UprightBox::around(indices, cloud.points(), table_axes, heights_m)?;
        let sides = config.side_min_m..=config.side_max_m;
        Some(Self {
            cluster,
            statistics,
            upright_box,
            support: statistics.is_standing.then_some(Support::Table),
            is_base_without_depth: false,
            off_table_share: 0.0,
            is_object_sized: sides.contains(&upright_box.longest_side_m()),
            is_masked: false,
        })
    }

    /// Height of the lower part of the box without any point, metres.
    pub(crate) fn occluded_base_m(&self) -> f64 {
        let ClusterStatistics {
            is_standing,
            has_low_points,
            height_m,
            ..
        } = self.statistics;
        if is_standing && !has_low_points {
            f64::from(height_m[0]).max(0.0)
        } else {
            0.0
        }
    }
}

/// Cluster statistics: centroid, mean colour, image bounds and height range.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ClusterStatistics {
    pub(crate) centroid: Point3<f64>,
    pub(crate) mean_rgb: [f32; 3],
    pub(crate) pixel_bounds: PixelBounds,
    pub(crate) height_m: [f32; 2],
    /// `true` when enough points are near the table for a standing object.
    pub(crate) has_low_points: bool,
    /// `true` for a standing object, including a round one that occludes its own contact
    /// area.
    pub(crate) is_standing: bool,
}

impl ClusterStatistics {
    /// Statistics of the pixels of a cluster, which must not be empty.
    pub(crate) fn of(
        pixels: &[u32],
        cloud: &OrganizedCloud<'_>,
        height: &AffineForm,
        config: &RawConfig,
    ) -> Self {
        let mut position = Vector3::<f64>::zeros();
        let (mut rgb, mut n_low) = ([0_u64; 3], 0_u32);
        let (mut pixel_bounds, mut height_m) =
            (PixelBounds::default(), [f32::INFINITY, f32::NEG_INFINITY]);
        // A 64-bit division takes twice as long.
        let width = cloud.width() as u32;
        for &pixel in pixels {
            let point = &cloud.points()[pixel as usize];
            position += point.position().coords;
            for (sum, value) in rgb.iter_mut().zip(point.color.rgb()) {
                *sum += u64::from(value);
            }
            pixel_bounds.add((pixel % width) as usize, (pixel / width) as usize);
            let h = height.at(point.x, point.y, point.z);
            height_m = [height_m[0].min(h), height_m[1].max(h)];
            n_low += u32::from(h <= config.standing_gap_max_m as f32);
        }
        let n = pixels.len().max(1) as f64;
        let [lowest_m, highest_m] = height_m;
        let is_round = lowest_m <= (ROUND_GAP_SHARE * highest_m).min(ROUND_GAP_MAX_M);
        let has_low_points = f64::from(n_low) >= (STANDING_SHARE * n).max(3.0);
        Self {
            centroid: (position / n).into(),
            mean_rgb: rgb.map(|sum| (sum as f64 / n) as f32),
            pixel_bounds,
            height_m,
            has_low_points,
            is_standing: is_round || has_low_points,
        }
    }
}
