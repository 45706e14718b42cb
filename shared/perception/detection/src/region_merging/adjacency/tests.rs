//! Region graphs of a rendered image of three regions side by side.

use super::*;
use crate::affine_form::AffineForm;
use crate::region_merging::FEATURE_NAMES;
use crate::segmentation::NO_EDGE;
use geometry::RigidTransform;
use point_cloud::{OrganizedCloud, Rgba};

const WIDTH: usize = 90;
const HEIGHT: usize = 40;
const PITCH: f32 = 1.0 / 292.0;

/// Graph of regions of 30 columns each, numbered by `number_of`; the depth steps back by 2 cm
/// from the second to the third. Between the first two the edges have the log odds `-6`.
fn graph(number_of: [u32; 3]) -> RegionAdjacency {
    let point = |i: usize| {
        let (column, row) = (i % WIDTH, i / WIDTH);
        let z = if column < 60 { 1.0 } else { 1.02 };
        let grey = 80 + 40 * (column / 30) as u8;
        Point {
            x: (column as f32 - 45.0) * PITCH * z,
            y: row as f32 * PITCH * z,
            z,
            color: Rgba::opaque(grey, grey, grey),
        }
    };
    let points: Vec<Point> = (0..WIDTH * HEIGHT).map(point).collect();
    let cloud = OrganizedCloud::new(&points, WIDTH, HEIGHT).unwrap();
    let image = CellImage::of_cloud(&cloud);
    assert_eq!(image.stride_px, 1);
    let table = TableReference {
        axes: AffineForm::coordinates_of(&RigidTransform::identity()),
        noise: DepthNoise::default(),
    };
    let mut bends = Bends::default();
    bends.refill(&image, PITCH, &table.noise);
    let column_of = |cell: &Cell| cell.pixel as usize % WIDTH;
    let cells = image.cells.iter();
    let region_of: Vec<u32> = cells.map(|cell| number_of[column_of(cell) / 30]).collect();
    let mut graph = RegionAdjacency::default();
    graph.clear(3);
    for (cell, &region) in image.cells.iter().zip(&region_of) {
        graph.add_cell(region, cell, &points[cell.pixel as usize], &table);
    }
    for (number, cell) in (0..).zip(&image.cells) {
        let next = number + 1;
        if column_of(cell) + 1 < WIDTH && region_of[next as usize] != region_of[number as usize] {
            let strength = if column_of(cell) < 45 { 0 } else { NO_EDGE };
            graph.add_pair([number, next], &region_of, strength);
        }
    }
    graph.connect(&image, &bends, &region_of, &table);
    graph
}

fn feature(features: &PairFeatures, name: &str) -> f32 {
    let at = FEATURE_NAMES.iter().position(|own| own.starts_with(name));
    features[at.unwrap()]
}

#[test]
fn features_tell_a_surface_from_a_step() {
    let graph = graph([0, 1, 2]);
    assert_eq!([graph.regions_of(0), graph.regions_of(1)], [[0, 1], [1, 2]]);
    let [flat, step] = [0, 1].map(|edge| graph.features(edge));
    for (name, expected) in [
        ("share of the boundary with unknown", [0.0, 1.0]),
        ("cosine between the normals", [1.0, 1.0]),
        ("distance of the smaller region's centroid", [0.0, 0.02]),
        ("convexity of the centroids", [0.0, 0.0]),
        ("mean depth step across", [0.0, 0.02]),
        ("mean log odds", [-6.0, 0.0]),
        ("share of the boundary across a gap", [0.0, 1.0]),
        ("1 for regions of one cluster", [1.0, 0.0]),
    ] {
        for (features, expected) in [flat, step].iter().zip(expected) {
            let found = feature(features, name);
            assert!((found - expected).abs() < 0.01, "{name}: {found}");
        }
    }
}

#[test]
fn merged_region_has_the_features_of_all_its_pixels() {
    let mut merged = graph([0, 1, 2]);
    assert_eq!(merged.merge(0), [0, 1]);
    assert_eq!(merged.regions_of(0), [0, 2]);
    let whole = graph([0, 0, 2]).features(0);
    for (i, (a, b)) in merged.features(0).into_iter().zip(whole).enumerate() {
        assert!((a - b).abs() < 1e-3, "feature {i}: {a} {b}");
    }
}

#[test]
fn boundaries_to_a_common_neighbour_are_added_up() {
    // The outer regions are one, so that both their boundaries are with the middle one.
    let around = graph([0, 1, 0]);
    let mut merged = graph([0, 2, 1]);
    let edges_of = |graph: &RegionAdjacency| graph.edges.len();
    assert_eq!((edges_of(&around), edges_of(&merged)), (1, 2));
    merged.join_boundaries(0, 1);
    assert_eq!((edges_of(&merged), merged.regions_of(0)), (1, [0, 2]));
    let [whole, joined] = [&around, &merged].map(|graph| graph.edges[0].boundary);
    assert_eq!(whole.n_pairs, joined.n_pairs);
    assert!((whole.step_m - joined.step_m).abs() < 1e-4);
}

#[test]
fn a_surface_is_merged_and_a_track_on_each_side_parts_it() {
    let merged = |claims: &[u32], joins_clusters: bool| {
        let mut joined = Vec::new();
        let mut graph = graph([0, 1, 2]);
        graph.claim(claims);
        let before = graph.edges.len();
        graph.rate(|_| true);
        let prior = graph.edges[0].log_odds;
        graph.merge_regions(joins_clusters, |a, b| joined.push([a, b]));
        assert_eq!(before, 2);
        (prior, joined)
    };
    let (unclaimed, joined) = merged(&[NO_TRACK; 3], false);
    assert_eq!(joined, [[0, 1]]);
    let (one_track, _) = merged(&[7, 7, NO_TRACK], true);
    let (two_tracks, _) = merged(&[7, 8, NO_TRACK], true);
    assert!((one_track - unclaimed - TRACK_LOG_ODDS).abs() < 1e-5);
    assert!((two_tracks - unclaimed + TRACK_LOG_ODDS).abs() < 1e-5);
}

#[test]
fn a_scrap_of_another_cluster_joins_no_clusters() {
    let are_apart = |clusters: [u32; 3], share: f32| {
        let mut graph = graph([0, 1, 2]);
        graph.cluster_of.copy_from_slice(&clusters);
        graph.describe_clusters();
        graph.regions[1].n_pixels_at_1m = share * graph.clusters[1].n_pixels_at_1m;
        graph.are_apart(0, &graph.features(0))
    };
    assert!(!are_apart([0, 1, 1], 0.5));
    assert!(are_apart([0, 1, 1], 0.05));
    // Within its own cluster a scrap belongs to what it touches.
    assert!(!are_apart([1, 1, 1], 0.05));
}

#[test]
fn examples_follow_the_known_objects() {
    let mut pairs = Vec::new();
    let objects = [Some(10), Some(10), Some(20)];
    graph([0, 1, 2]).add_examples(&objects, &mut pairs);
    let truths: Vec<bool> = pairs.iter().map(|pair| pair.is_one_object).collect();
    // Both edges at first, and the remaining one after the merge of the first two.
    assert_eq!(truths, [true, false, false]);
    pairs.clear();
    graph([0, 1, 2]).add_examples(&[None, Some(10), None], &mut pairs);
    assert!(pairs.is_empty());
}
