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
    fn concavity_split_loses_no_pixel(
        image in image(), creased in prop::collection::vec(any::<bool>(), WIDTH * 8),
    ) {
        let points = points(&image);
        let pixels: Vec<u32> =
            (0..image.len() as u32).filter(|&i| image[i as usize].is_some()).collect();
        let cloud = OrganizedCloud::new(&points, WIDTH, 8).unwrap();
        let (mut clusters, mut split) = (Clusters::default(), ConcavitySplit::default());
        clusters.label_components(&cloud, &Sequential, &pixels, 2);
        for cluster in 0..clusters.len() {
            let whole = clusters.pixels(cluster).to_vec();
            let (mut split_pixels, sizes) = split.split_along(&cloud, &whole, &creased, 3);
            let mut others = split_pixels.as_slice();
            for &size in &sizes {
                let part;
                (part, others) = others.split_at(size as usize);
                prop_assert!(!part.is_empty() && part.is_sorted());
            }
            prop_assert!(!sizes.is_empty() && others.is_empty());
            split_pixels.sort_unstable();
            prop_assert_eq!(split_pixels, whole);
        }
    }
}
