//! Sides among candidates: "the orange at the back" of two oranges is the one that is further back.

use super::{Grounder, MATCH_MIN, Rating};
use crate::expression::NounPhrase;
use crate::relation::{TablePlace, ViewFrame};

/// Lead of a candidate to a side from which on it is clearly further, in metres.
/// Chosen: half a cup.
const LEAD_MIN_M: f64 = 0.04;

/// Share of the best score from which on an object is a candidate.
const CANDIDATE_SHARE: f64 = 0.5;

/// Factor of the score of the candidate that is furthest to a side. Chosen: as that of a place
/// without doubt.
const FURTHEST_SCORE: f64 = 0.6;

/// Greatest factor of the scores of the others, so that they do not compete.
const OTHERS_SCORE: f64 = 0.75;

impl Grounder<'_> {
    /// Prefers the candidate furthest to the side that a phrase names. `before` are the ratings
    /// without the side.
    pub(super) fn prefer_furthest(
        &self,
        phrase: &NounPhrase,
        before: &[Rating],
        ratings: &mut [Rating],
    ) {
        let (Some(side), Some(view)) = (phrase.compared_side(), self.view) else {
            return;
        };
        let Some(direction) = direction(side, &view) else {
            return;
        };
        let best = before.iter().map(|r| r.score).fold(0.0, f64::max);
        let score_min = MATCH_MIN.max(CANDIDATE_SHARE * best);
        let along_m = |index: usize| self.geometries[index].centre.dot(&direction);
        let mut candidates: Vec<usize> = (0..before.len())
            .filter(|i| before[*i].score >= score_min && along_m(*i).is_finite())
            .collect();
        candidates.sort_by(|a, b| along_m(*b).total_cmp(&along_m(*a)));
        let [first, second, ..] = candidates[..] else {
            return;
        };
        if along_m(first) - along_m(second) < LEAD_MIN_M {
            return;
        }
        let (track, place) = (self.track(first), side.word());
        let fits_alone = ratings[first].score >= MATCH_MIN;
        let rival = ratings[second].score >= MATCH_MIN;
        let furthest = &mut ratings[first];
        furthest.score = furthest.score.max(FURTHEST_SCORE * before[first].score);
        if !fits_alone {
            furthest.lacks.clone_from(&before[first].lacks);
            furthest.fits.push(format!("is furthest {place}"));
        }
        if rival || !fits_alone {
            let doubt = format!("track {track} is {place} only in comparison");
            furthest.doubts.push(doubt);
        }
        let most = OTHERS_SCORE * furthest.score;
        for other in &candidates[1..] {
            ratings[*other].score = ratings[*other].score.min(most);
        }
    }
}

fn direction(side: TablePlace, view: &ViewFrame) -> Option<nalgebra::Vector3<f64>> {
    match side {
        TablePlace::Left => Some(-view.right),
        TablePlace::Right => Some(view.right),
        TablePlace::Front => Some(-view.forward),
        TablePlace::Back => Some(view.forward),
        TablePlace::Middle | TablePlace::Anywhere => None,
    }
}
