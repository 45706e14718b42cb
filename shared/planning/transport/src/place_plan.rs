//! Plan of the places of an object: those that are possible, and the reasons of the others.

use crate::place_area::PlaceArea;
use crate::place_rejection::PlaceRejection;
use crate::placing::PlacePose;
use grasping::GraspScene;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Number of reasons that are told.
const N_TOLD: usize = 3;

/// Places of an object in an area.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlacePlan {
    /// Places, best first.
    pub placements: Vec<PlacePose>,
    /// Reasons of the rejected ones, in the order in which they were tried.
    pub rejected: Vec<PlaceRejection>,
}

impl PlacePlan {
    /// Sentence that says why there is no place; `None` when there is one.
    pub fn why_none(&self, scene: &GraspScene<'_>, area: &PlaceArea) -> Option<String> {
        if !self.placements.is_empty() {
            return None;
        }
        let name = &area.name;
        let mut counts = BTreeMap::<(bool, String), usize>::new();
        let is_large = self.rejected.iter().all(PlaceRejection::is_over_outline);
        for reason in &self.rejected {
            if is_large || !reason.is_over_outline() {
                let key = (reason.is_occupied(), reason.words(scene));
                *counts.entry(key).or_default() += 1;
            }
        }
        let mut reasons: Vec<_> = counts.into_iter().collect();
        reasons.sort_by_key(|(_, n)| Reverse(*n));
        let told = reasons.iter().take(N_TOLD);
        let told: Vec<String> = told
            .map(|((_, words), n)| format!("{n} × {words}"))
            .collect();
        let n: usize = reasons.iter().map(|(_, n)| n).sum();
        let n_occupied = reasons.iter().filter(|((is_occupied, _), _)| *is_occupied);
        let n_occupied: usize = n_occupied.map(|(_, n)| n).sum();
        let says = match n {
            0 => return Some(format!("the place {name} has no room at all")),
            _ if 2 * n_occupied > n => "is full",
            _ => "cannot be used",
        };
        Some(format!(
            "the place {name} {says}; of {n} poses none is possible: {}",
            told.join("; ")
        ))
    }
}
