//! Ranks among the objects that fit the rest of a phrase: "the second biggest mug".

use super::{Grounder, MATCH_MIN, Rating};
use crate::expression::{Ranking, RankingKey};
use crate::size::Degree;

/// Share of the best score from which on an object takes part in a ranking.
const CANDIDATE_SHARE: f64 = 0.5;

/// Difference of places that a person sees, in metres. Chosen.
const PLACE_TIE_M: f64 = 0.01;

/// Factor of a tie below which a difference of sizes is doubtful: 95 % of the measured differences
/// between objects of one category deviate less from the true ones.
const SURE_TIES: f64 = 3.0;

/// Factor of the score of an object that ties with the one of the asked rank.
const TIE_SCORE: f64 = 0.95;

/// Keys of all objects, the first rank having the greatest.
struct RankKeys {
    values: Vec<f64>,
    /// Greatest difference of a tie.
    tie: f64,
    /// Least difference without doubt.
    sure: f64,
}

impl RankKeys {
    fn new(values: Vec<f64>, tie: f64) -> Self {
        let sure = tie;
        Self { values, tie, sure }
    }

    fn sizes(values: Vec<f64>, tie: f64) -> Self {
        let sure = SURE_TIES * tie;
        Self { values, tie, sure }
    }

    /// Candidate that hardly differs from the chosen one.
    fn close_to(&self, chosen: usize, candidates: &[usize]) -> Option<usize> {
        let differs = |other: &&usize| {
            let difference = (self.values[**other] - self.values[chosen]).abs();
            difference > self.tie && difference < self.sure
        };
        candidates.iter().find(differs).copied()
    }
}

impl Grounder<'_> {
    /// Keeps the object of a rank, and those that tie with it.
    pub(super) fn apply_ranking(&mut self, ranking: &Ranking, ratings: &mut [Rating]) {
        let Some(rank_keys) = self.ranking_keys(ranking) else {
            return;
        };
        let keys = &rank_keys.values;
        let words = self.text(ranking.span);
        let best = ratings.iter().map(|r| r.score).fold(0.0, f64::max);
        let score_min = MATCH_MIN.max(CANDIDATE_SHARE * best);
        let mut candidates: Vec<usize> = (0..ratings.len())
            .filter(|i| ratings[*i].score >= score_min && keys[*i].is_finite())
            .collect();
        candidates.sort_by(|a, b| keys[*b].total_cmp(&keys[*a]));
        let chosen = candidates.get(ranking.rank - 1).copied();
        let doubtful = chosen.and_then(|chosen| {
            (0..ratings.len()).find(|i| {
                ratings[*i].score >= MATCH_MIN && !candidates.contains(i) && keys[*i] > keys[chosen]
            })
        });
        for (index, rating) in ratings.iter_mut().enumerate() {
            let is_tie = chosen.is_some_and(|chosen| {
                candidates.contains(&index) && (keys[index] - keys[chosen]).abs() <= rank_keys.tie
            });
            if Some(index) == chosen {
                rating.fits.push(format!("is `{words}`"));
            } else if is_tie {
                rating.score *= TIE_SCORE;
                rating.doubts.push(format!(
                    "track {} and another are equally `{words}`",
                    self.track(index)
                ));
            } else {
                rating.score = 0.0;
                rating.lacks.push(format!("is not `{words}`"));
            }
        }
        let Some(chosen) = chosen else {
            return;
        };
        let track = |index: Option<usize>| index.map(|index| self.track(index));
        if let Some(track) = track(doubtful) {
            let doubt = format!("track {track} may count, too, and comes before");
            ratings[chosen].doubts.push(doubt);
        }
        if let Some(other) = track(rank_keys.close_to(chosen, &candidates)) {
            let doubt = format!(
                "tracks {} and {other} hardly differ there",
                self.track(chosen)
            );
            ratings[chosen].doubts.push(doubt);
        }
    }

    /// Keys of all objects. None if the ranking cannot be judged, which is noted.
    fn ranking_keys(&mut self, ranking: &Ranking) -> Option<RankKeys> {
        let along =
            |grounder: &Self, key: fn(&crate::relation::ViewFrame) -> nalgebra::Vector3<f64>| {
                let direction = key(grounder.view.as_ref()?);
                let keys = grounder.geometries.iter().map(|g| g.centre.dot(&direction));
                Some(RankKeys::new(keys.collect(), PLACE_TIE_M))
            };
        let keys = match &ranking.key {
            RankingKey::Size(dimension, degree) => {
                let sign = if *degree == Degree::More { 1.0 } else { -1.0 };
                let sizes = self.geometries.iter().map(|g| sign * dimension.scale(g));
                Some(RankKeys::sizes(sizes.collect(), dimension.scale_error()))
            }
            RankingKey::Leftmost => along(self, |view| -view.right),
            RankingKey::Rightmost => along(self, |view| view.right),
            RankingKey::Frontmost => along(self, |view| -view.forward),
            RankingKey::Rearmost => along(self, |view| view.forward),
            RankingKey::Nearest => self.distances(-1.0),
            RankingKey::Farthest => self.distances(1.0),
            RankingKey::NearestTo(landmark) => {
                return self.landmark_distances(landmark, ranking, -1.0);
            }
            RankingKey::FarthestFrom(landmark) => {
                return self.landmark_distances(landmark, ranking, 1.0);
            }
            RankingKey::Topmost => Some(self.keys(|_, g| g.top_m(), PLACE_TIE_M)),
            RankingKey::Lowest => Some(self.keys(|_, g| -g.bottom_m(), PLACE_TIE_M)),
            RankingKey::Newest => Some(self.keys(|o, _| o.first_seen_ns as f64, 0.0)),
            RankingKey::Oldest => Some(self.keys(|o, _| -(o.first_seen_ns as f64), 0.0)),
            RankingKey::LastSeen => Some(self.keys(|o, _| o.last_seen_ns as f64, 0.0)),
        };
        if keys.is_none() {
            self.ignore(ranking.span, "the pose of the camera is not known");
        }
        keys
    }

    fn keys(
        &self,
        key: fn(&crate::world::WorldObject, &crate::box_geometry::BoxGeometry) -> f64,
        tie: f64,
    ) -> RankKeys {
        let pairs = self.world.objects.iter().zip(&self.geometries);
        let keys = pairs.map(|(object, geometry)| key(object, geometry));
        RankKeys::new(keys.collect(), tie)
    }

    fn distances(&self, sign: f64) -> Option<RankKeys> {
        let position = self.view.as_ref()?.position;
        let distance = |g: &crate::box_geometry::BoxGeometry| (g.centre - position).norm();
        let keys = self.geometries.iter().map(|g| sign * distance(g));
        Some(RankKeys::new(keys.collect(), PLACE_TIE_M))
    }

    /// Gaps to the best landmark; the landmark itself takes no part.
    fn landmark_distances(
        &mut self,
        phrase: &crate::expression::NounPhrase,
        ranking: &Ranking,
        sign: f64,
    ) -> Option<RankKeys> {
        let landmarks = self.landmarks_or_ignore(phrase, ranking.span)?;
        let text = self.text(phrase.span);
        let Some(landmark) = landmarks.first() else {
            self.ignore(ranking.span, &format!("nothing here fits `{text}`"));
            return None;
        };
        let index = landmark.index;
        if landmarks
            .get(1)
            .is_some_and(|second| second.weight >= super::COMPETING_SHARE)
        {
            let track = self.track(index);
            self.doubt(format!(
                "several objects fit `{text}`; track {track} was taken"
            ));
        }
        for doubt in landmark.doubts.clone() {
            self.doubt(doubt);
        }
        let gap = |(other, geometry): (usize, &crate::box_geometry::BoxGeometry)| {
            if other == index {
                f64::NEG_INFINITY
            } else {
                sign * geometry.gap_m(&self.geometries[index])
            }
        };
        let gaps = self.geometries.iter().enumerate().map(gap);
        Some(RankKeys::new(gaps.collect(), PLACE_TIE_M))
    }
}
