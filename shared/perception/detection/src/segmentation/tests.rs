//! Segmentation of rendered boxes.

use super::*;
use crate::affine_form::AffineForm;
use crate::parallelism::{ScopedThreads, Sequential};
use geometry::{OrientedBox, RigidTransform};
use nalgebra::{Isometry3, Vector3};
use point_cloud::{Point, Rgba};
use sensor_noise::DepthNoise;

const WIDTH: usize = 320;
const HEIGHT: usize = 240;
const PITCH: f32 = 1.0 / 292.0;

/// Image from above of a table at 1 m with `depth_of(column, row)` where something stands on it.
fn image(depth_of: impl Fn(usize, usize) -> Option<(f32, [u8; 3])>) -> Vec<Point> {
    let point = |i: usize| {
        let (column, row) = (i % WIDTH, i / WIDTH);
        let (z, [r, g, b]) = depth_of(column, row).unwrap_or((1.0, [180, 170, 160]));
        Point {
            x: (column as f32 - 160.0) * PITCH * z,
            y: (row as f32 - 120.0) * PITCH * z,
            z,
            color: Rgba::opaque(r, g, b),
        }
    };
    (0..WIDTH * HEIGHT).map(point).collect()
}

fn clusters_above_table(points: &[Point]) -> Clusters {
    let cloud = OrganizedCloud::new(points, WIDTH, HEIGHT).unwrap();
    let is_above = |&pixel: &u32| points[pixel as usize].z < 0.995;
    let above: Vec<u32> = (0..points.len() as u32).filter(is_above).collect();
    let mut clusters = Clusters::default();
    clusters.label_components(&cloud, &Sequential, &above, 20);
    clusters
}

fn input<'a>(points: &'a [Point], tracks: &'a [ExpectedTrack]) -> SegmentationInput<'a> {
    // The table looks at the camera: its height axis is against the optical axis.
    let table_from_camera = Isometry3::new(
        Vector3::new(0.0, 0.0, 1.0),
        Vector3::x() * std::f64::consts::PI,
    );
    SegmentationInput {
        cloud: OrganizedCloud::new(points, WIDTH, HEIGHT).unwrap(),
        table: TableReference {
            axes: AffineForm::coordinates_of(&RigidTransform::from(table_from_camera)),
            noise: DepthNoise::default(),
        },
        pixel_pitch: PITCH,
        tracks,
        joins_clusters: true,
    }
}

/// A wide box 10 cm high, on which a small one of another colour stands, 6 cm high.
fn box_on_box(column: usize, row: usize) -> Option<(f32, [u8; 3])> {
    let is_within = |columns: std::ops::Range<usize>, rows: std::ops::Range<usize>| {
        columns.contains(&column) && rows.contains(&row)
    };
    if is_within(130..180, 100..140) {
        Some((0.84, [40, 60, 190]))
    } else {
        is_within(80..220, 70..170).then_some((0.90, [200, 60, 50]))
    }
}

fn sorted_sizes(clusters: &Clusters) -> Vec<usize> {
    let mut sizes: Vec<usize> = (0..clusters.len())
        .map(|i| clusters.pixels(i).len())
        .collect();
    sizes.sort_unstable();
    sizes
}

#[test]
fn no_cluster_needs_no_segmentation() {
    let points = image(|_, _| None);
    let mut clusters = clusters_above_table(&points);
    Segmentation::default().segment(&input(&points, &[]), &mut clusters, &Sequential);
    assert_eq!(clusters.len(), 0);
}

#[test]
fn segmentation_keeps_all_pixels_in_one_cluster_each() {
    let points = image(box_on_box);
    let mut clusters = clusters_above_table(&points);
    let n_before: usize = sorted_sizes(&clusters).iter().sum();
    Segmentation::default().segment(&input(&points, &[]), &mut clusters, &Sequential);
    assert_eq!(sorted_sizes(&clusters).iter().sum::<usize>(), n_before);
    let mut seen = vec![false; points.len()];
    for cluster in 0..clusters.len() {
        for &pixel in clusters.pixels(cluster) {
            assert_eq!(clusters.cluster_of[pixel as usize], cluster as u32);
            assert!(!std::mem::replace(&mut seen[pixel as usize], true));
        }
    }
}

#[test]
fn a_box_on_a_box_is_another_object_on_any_number_of_threads() {
    let points = image(box_on_box);
    let segmented = |parallelism: &dyn Parallelism| {
        let mut clusters = clusters_above_table(&points);
        Segmentation::default().segment(&input(&points, &[]), &mut clusters, parallelism);
        clusters
    };
    let clusters = segmented(&Sequential);
    let sizes = sorted_sizes(&clusters);
    assert_eq!(sizes.len(), 2, "{sizes:?}");
    assert!(sizes[0].abs_diff(50 * 40) < 250, "{sizes:?}");
    let parallel = segmented(&ScopedThreads(2));
    assert_eq!(clusters.cluster_of, parallel.cluster_of);
}

/// Track with a box around columns and rows of the image at a depth.
fn track(columns: [f64; 2], rows: [f64; 2], depth_m: [f64; 2]) -> ExpectedTrack {
    let pitch = f64::from(PITCH);
    let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
    let z = middle(depth_m);
    let centre = Vector3::new(
        (middle(columns) - 160.0) * pitch * z,
        (middle(rows) - 120.0) * pitch * z,
        z,
    );
    let half = |[a, b]: [f64; 2]| 0.5 * (b - a) * pitch;
    let half_sides_m = Vector3::new(half(columns), half(rows), 0.5 * (depth_m[1] - depth_m[0]));
    ExpectedTrack {
        n_points: 5_000,
        ..ExpectedTrack::from(OrientedBox {
            frame_from_box: Isometry3::new(centre, Vector3::zeros()),
            half_sides_m,
        })
    }
}

#[test]
fn regions_are_claimed_by_the_track_with_the_smallest_box_around_them() {
    let points = image(box_on_box);
    let clusters = clusters_above_table(&points);
    let tracks = [
        track([75.0, 225.0], [65.0, 175.0], [0.83, 1.0]),
        track([128.0, 182.0], [98.0, 142.0], [0.83, 0.9]),
        track([0.0, 20.0], [0.0, 20.0], [0.8, 1.0]),
    ];
    let mut segmentation = Segmentation::default();
    let input = input(&points, &tracks);
    segmentation.find_regions(&input, &clusters, &Sequential);
    let claims = segmentation.region_claims.find(
        &input.cloud,
        &segmentation.image.cells,
        &segmentation.watershed,
        &tracks,
    );
    let cells = segmentation.image.cells.iter();
    for (cell, &region) in cells.zip(&segmentation.watershed.region_of) {
        // Where a region is on one box only, its claim is clear.
        let expected = u32::from(cell.depth_m < 0.87);
        let is_mixed = claims[region as usize] != expected;
        let (column, row) = (cell.pixel as usize % WIDTH, cell.pixel as usize / WIDTH);
        let edge = column.abs_diff(130).min(column.abs_diff(180));
        let edge = edge.min(row.abs_diff(100)).min(row.abs_diff(140));
        assert!(!is_mixed || edge < 20, "{column} {row}");
    }
    let without = segmentation.region_claims.find(
        &input.cloud,
        &segmentation.image.cells,
        &segmentation.watershed,
        &[],
    );
    assert!(without.iter().all(|&claim| claim == NO_TRACK));
}

/// A box that a higher bar crosses, so that its two ends are seen, at these depths.
fn crossed_box(ends_m: [f32; 2], has_bar: bool) -> Vec<Point> {
    image(|column, row| {
        if has_bar && (145..175).contains(&column) && (20..220).contains(&row) {
            return Some((0.75, [40, 60, 190]));
        }
        let is_end = |columns: std::ops::Range<usize>| columns.contains(&column);
        let is_along = (100..140).contains(&row);
        if is_along && is_end(90..146) {
            Some((ends_m[0], [200, 60, 50]))
        } else if is_along && is_end(174..230) {
            Some((ends_m[1], [200, 120, 50]))
        } else {
            None
        }
    })
}

fn n_objects(points: &[Point], input: &SegmentationInput<'_>) -> usize {
    let mut clusters = clusters_above_table(points);
    Segmentation::default().segment(input, &mut clusters, &Sequential);
    clusters.len()
}

#[test]
fn amodal_completion_unites_the_ends_of_a_box_behind_an_occluder() {
    let points = crossed_box([0.9; 2], true);
    assert_eq!(n_objects(&points, &input(&points, &[])), 2);
    let parts_apart = SegmentationInput {
        joins_clusters: false,
        ..input(&points, &[])
    };
    assert_eq!(n_objects(&points, &parts_apart), 3);
    // Two tracks have them.
    let ends = [[85.0, 147.0], [173.0, 235.0]];
    let tracks = ends.map(|columns| track(columns, [95.0, 145.0], [0.88, 1.0]));
    assert_eq!(n_objects(&points, &input(&points, &tracks)), 3);
}

#[test]
fn amodal_completion_keeps_boxes_of_two_heights_and_those_with_a_gap_apart() {
    let other_height = crossed_box([0.9, 0.86], true);
    assert_eq!(n_objects(&other_height, &input(&other_height, &[])), 3);
    let gap = crossed_box([0.9; 2], false);
    assert_eq!(n_objects(&gap, &input(&gap, &[])), 2);
}
