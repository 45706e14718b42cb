//! Training examples of region merging from clusters with known objects.

use super::ConcavitySplit;
use crate::region_merging::RegionPair;
use crate::table_reference::TableReference;
use point_cloud::OrganizedCloud;
use random::Random;
use std::collections::BTreeMap;

/// Least share of a region's pixels on its main object for a training example. Chosen.
const PURITY_MIN: f64 = 0.8;

/// Collector of training examples.
pub(crate) struct RegionExamples<'a> {
    pub(crate) split: ConcavitySplit,
    pub(crate) random: Random,
    pub(crate) pairs: &'a mut Vec<RegionPair>,
}

impl RegionExamples<'_> {
    /// Add the pairs of adjacent regions of a cluster whose objects are known, before and
    /// during the merging of all regions of one object in a random order.
    ///
    /// `object_of` gives the object of a pixel of the image; `None` for one without.
    pub(crate) fn add_cluster(
        &mut self,
        cloud: &OrganizedCloud<'_>,
        cluster: &[u32],
        table: &TableReference,
        object_of: impl Fn(u32) -> Option<u16>,
    ) {
        if self.split.find_regions(cloud, cluster, table) {
            let objects = self.objects_of_regions(cluster, object_of);
            self.split
                .adjacency
                .list_examples(&objects, &mut self.random, self.pairs);
        }
    }

    /// Main object of each region; `None` for a region of several objects.
    fn objects_of_regions(
        &self,
        cluster: &[u32],
        object_of: impl Fn(u32) -> Option<u16>,
    ) -> Vec<Option<u16>> {
        let ConcavitySplit { patch, parents, .. } = &self.split;
        let mut counts = vec![BTreeMap::<Option<u16>, usize>::new(); parents.len()];
        for (own, &pixel) in patch.pixels.iter().zip(cluster) {
            let region = patch.part_of[own.index as usize] as usize;
            *counts[region].entry(object_of(pixel)).or_default() += 1;
        }
        let main_object = |counts: &BTreeMap<Option<u16>, usize>| {
            let n = counts.values().sum::<usize>();
            let (object, n_main) = counts.iter().max_by_key(|(_, n)| **n)?;
            let is_pure = *n_main as f64 >= PURITY_MIN * n as f64;
            object.filter(|_| is_pure)
        };
        counts.iter().map(main_object).collect()
    }
}
