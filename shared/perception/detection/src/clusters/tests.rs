//! Clusters compared with brute force.

use super::*;
use crate::parallelism::{ScopedThreads, Sequential};
use point_cloud::OrganizedCloud;
use point_cloud::Rgba;
use proptest::prelude::*;

const WIDTH: usize = 12;

/// Depth steps around 1 m; `None` is outside of the prism.
fn image() -> impl Strategy<Value = Vec<Option<u8>>> {
    prop::collection::vec(prop::option::weighted(0.8, 0..4_u8), WIDTH * 8)
}

fn points(image: &[Option<u8>]) -> Vec<Point> {
    let point = |(i, step): (usize, &Option<u8>)| Point {
        x: (i % WIDTH) as f32 * 0.002,
        y: (i / WIDTH) as f32 * 0.002,
        z: 1.0 + 0.006 * f32::from(step.unwrap_or(0)),
        color: Rgba::default(),
    };
    image.iter().enumerate().map(point).collect()
}

/// Linked neighbours of a pixel, nearest one per direction.
fn linked(points: &[Point], inside: &[bool], pixel: usize) -> Vec<usize> {
    let near = |other: &usize| {
        let limit = LINKS.floor_m + LINKS.per_m2 * points[pixel].z * points[pixel].z;
        inside[*other] && squared_distance(&points[pixel], &points[*other]) <= limit * limit
    };
    let (column, row) = (pixel % WIDTH, pixel / WIDTH);
    let mut found: Vec<usize> = Vec::new();
    found.extend((1..=3.min(column)).map(|step| pixel - step).find(near));
    found.extend((1..=3.min(row)).map(|step| pixel - step * WIDTH).find(near));
    if row > 0 && column > 0 {
        found.extend(Some(pixel - WIDTH - 1).filter(near));
    }
    if row > 0 && column + 1 < WIDTH {
        found.extend(Some(pixel - WIDTH + 1).filter(near));
    }
    found
}

/// Clusters by propagating the smallest pixel number until nothing changes.
fn clusters_by_spreading(points: &[Point], inside: &[bool]) -> Vec<usize> {
    let mut first: Vec<usize> = (0..points.len()).collect();
    loop {
        let before = first.clone();
        for pixel in (0..points.len()).filter(|&pixel| inside[pixel]) {
            for other in linked(points, inside, pixel) {
                let least = first[pixel].min(first[other]);
                (first[pixel], first[other]) = (least, least);
            }
        }
        if first == before {
            return first;
        }
    }
}

proptest! {
    #[test]
    fn clusters_match_brute_force(image in image(), n_min in 1..6_u32) {
        let points = points(&image);
        let inside: Vec<bool> = image.iter().map(Option::is_some).collect();
        let pixels: Vec<u32> = (0..image.len() as u32).filter(|&i| inside[i as usize]).collect();
        let cloud = OrganizedCloud::new(&points, WIDTH, 8).unwrap();
        let mut clusters = Clusters::default();
        clusters.label_components(&cloud, &ScopedThreads(2), &pixels, n_min);
        let first = clusters_by_spreading(&points, &inside);
        let mut expected: Vec<Vec<u32>> = (0..image.len())
            .map(|root| pixels.iter().copied().filter(|&p| first[p as usize] == root).collect())
            .collect();
        expected.retain(|pixels: &Vec<u32>| pixels.len() >= n_min as usize);
        let found: Vec<Vec<u32>> = (0..clusters.len()).map(|i| clusters.pixels(i).to_vec()).collect();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn relabelled_pixels_are_grouped_by_their_new_cluster(
        image in image(), labels in prop::collection::vec(0..5_u32, WIDTH * 8),
    ) {
        let points = points(&image);
        let pixels: Vec<u32> =
            (0..image.len() as u32).filter(|&i| image[i as usize].is_some()).collect();
        let cloud = OrganizedCloud::new(&points, WIDTH, 8).unwrap();
        let mut clusters = Clusters::default();
        clusters.label_components(&cloud, &Sequential, &pixels, 1);
        let label = |pixel: usize| match labels[pixel] {
            4 => NO_CLUSTER,
            label => label,
        };
        let before = clusters.cluster_of.clone();
        clusters.relabel(WIDTH, 4, |pixel| {
            assert_eq!(pixel.index, pixel.row * WIDTH + pixel.column);
            assert_eq!(pixel.cluster, before[pixel.index]);
            label(pixel.index)
        });
        prop_assert_eq!(clusters.len(), 4);
        for cluster in 0..4 {
            let expected: Vec<u32> =
                pixels.iter().copied().filter(|&p| label(p as usize) == cluster as u32).collect();
            prop_assert_eq!(clusters.pixels(cluster), &expected);
        }
    }
}
