//! Training examples of the segmentation from images with known objects.

use super::cell_image::NO_CELL;
use super::edge_features::{EdgeFeatures, EdgeLines};
use super::{Segmentation, SegmentationInput};
use crate::clusters::Clusters;
use crate::parallelism::Sequential;
use crate::region_merging::RegionPair;
use random::Random;
use std::collections::BTreeMap;

/// Least share of a region's pixels on its main object for a training example. Chosen.
const PURITY_MIN: f64 = 0.8;

/// Number of edges inside of objects that are drawn for each one between objects. Chosen.
const INSIDE_PER_BOUNDARY: usize = 2;

/// Least number of edges inside of objects that are drawn from an image.
const INSIDE_MIN: usize = 500;

/// Edge between two neighbouring cells, with its class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeExample {
    /// Features of the edge.
    pub features: EdgeFeatures,
    /// `true` when its cells are of two objects.
    pub is_boundary: bool,
}

/// Training examples of one or more images.
#[derive(Debug, Default)]
pub struct SegmentationExamples {
    /// Edges within clusters: all between objects, and a sample of the others.
    pub edges: Vec<EdgeExample>,
    /// Pairs of adjacent regions, before and during merging.
    pub pairs: Vec<RegionPair>,
}

impl Segmentation {
    /// Add the examples of one image. `objects` holds the object of each pixel, `None` where there
    /// is none, or it is unknown. Edges inside of objects are drawn from `random`.
    pub(crate) fn add_examples(
        &mut self,
        (input, clusters): (&SegmentationInput<'_>, &Clusters),
        objects: &[Option<u16>],
        random: &mut Random,
        examples: &mut SegmentationExamples,
    ) {
        self.find_regions(input, clusters, &Sequential);
        let cells = self.image.cells.iter();
        let object_of_cell: Vec<Option<u16>> = cells
            .map(|cell| objects.get(cell.pixel as usize).copied().flatten())
            .collect();
        let pitch = self.image.pitch(input.pixel_pitch);
        for lines in EdgeLines::of(&self.image, &self.bends, pitch, input.table.noise) {
            self.add_edges(&lines, &object_of_cell, random, &mut examples.edges);
        }
        let objects = self.objects_of_regions(&object_of_cell);
        self.adjacency.add_examples(&objects, &mut examples.pairs);
    }

    fn add_edges(
        &self,
        lines: &EdgeLines<'_>,
        object_of_cell: &[Option<u16>],
        random: &mut Random,
        examples: &mut Vec<EdgeExample>,
    ) {
        let (mut boundary, mut inside) = (Vec::new(), Vec::new());
        for (cell, object) in self.image.cells.iter().zip(object_of_cell) {
            let place = cell.place as usize;
            let other = self.image.number_of[place + lines.step];
            if other == NO_CELL || self.image.cells[other as usize].cluster != cell.cluster {
                continue;
            }
            match (object, object_of_cell[other as usize]) {
                (Some(own), Some(other)) if *own == other => inside.push(place),
                (Some(_), Some(_)) => boundary.push(place),
                _ => {}
            }
        }
        let n_inside = (INSIDE_PER_BOUNDARY * boundary.len()).max(INSIDE_MIN / 2);
        let n_inside = n_inside.min(inside.len());
        let drawn = (0..n_inside).filter_map(|_| random.choice(&inside).copied());
        let inside: Vec<usize> = drawn.collect();
        for (places, is_boundary) in [(boundary, true), (inside, false)] {
            examples.extend(places.iter().map(|&place| EdgeExample {
                features: lines.features(place).map(|feature| feature[0]),
                is_boundary,
            }));
        }
    }

    /// Main object of each region; `None` for a region of several objects.
    fn objects_of_regions(&self, object_of_cell: &[Option<u16>]) -> Vec<Option<u16>> {
        let n_regions = self.watershed.regions.len();
        let mut counts = vec![BTreeMap::<Option<u16>, u32>::new(); n_regions];
        let cells = self.image.cells.iter().zip(object_of_cell);
        for ((cell, object), &region) in cells.zip(&self.watershed.region_of) {
            *counts[region as usize].entry(*object).or_default() += cell.n_pixels;
        }
        let main_object = |counts: &BTreeMap<Option<u16>, u32>| {
            let n = counts.values().sum::<u32>();
            let (object, n_main) = counts.iter().max_by_key(|(_, n)| **n)?;
            let is_pure = f64::from(*n_main) >= PURITY_MIN * f64::from(n);
            object.filter(|_| is_pure)
        };
        counts.iter().map(main_object).collect()
    }
}
