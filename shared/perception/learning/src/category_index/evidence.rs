//! Evidence of descriptions for categories, and the decision over several of them.

use super::CategoryIndex;
use super::local_ridge::local_regression;
use crate::calibration::{DistanceSum, MemorySize};
use crate::nearest_categories::ScoredView;
use crate::novelty_prior::{prior_with, under_prior};
use crate::recognition::N_NEAREST;
use crate::{CategoryName, Neighbour, Recognition, UnknownRule, ViewId};
use std::collections::BTreeMap;

/// Number of nearest views that the regression uses. On mesh categories 64 views are as
/// good as 128.
pub(super) const N_NEIGHBOURS: usize = 128;

/// Evidence of one description for the categories of its nearest views.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Evidence {
    scores: Vec<CategoryScore>,
    /// Distance of the farthest neighbour: all views of other categories are farther.
    radius: f32,
}

/// Evidence of one description for one category.
#[derive(Debug, Clone, PartialEq)]
struct CategoryScore {
    category: CategoryName,
    /// Regression of the category's indicator.
    score: f32,
    /// Nearest view of the category with its distance.
    nearest: (f32, ViewId),
}

/// Evidence for a category, summed over descriptions.
#[derive(Debug, Clone, Copy)]
struct SummedScore {
    score: f32,
    /// Sum of the distances beyond the radii.
    distance: f32,
    nearest: (f32, ViewId),
}

impl Evidence {
    /// Score of a category; zero if none of its views is near.
    pub(super) fn score(&self, category: &CategoryName) -> f32 {
        let mut scores = self.scores.iter();
        let of_category = scores.find(|score| score.category == *category);
        of_category.map_or(0.0, |found| found.score)
    }
}

impl CategoryIndex {
    /// Evidence of a description, in any axis hypothesis, with these nearest views, nearest first.
    pub(super) fn evidence(
        &self,
        description: Option<&[f32]>,
        neighbours: &[ScoredView],
    ) -> Evidence {
        let calibration = self.calibration.as_ref().filter(|_| !neighbours.is_empty());
        let (Some(calibration), Some(description)) = (calibration, description) else {
            return Evidence::default();
        };
        let neighbours = &neighbours[..neighbours.len().min(N_NEIGHBOURS)];
        let regression = local_regression(description, neighbours, &self.views, calibration);
        let mut scores: Vec<CategoryScore> = Vec::new();
        let weighted = regression.weights.iter().zip(regression.squared_distances);
        for (neighbour, (weight, squared_distance)) in neighbours.iter().zip(weighted) {
            let name = &self.views.view(neighbour.row).name;
            let weight = *weight as f32;
            let here = (self.distance_of(squared_distance), neighbour.view);
            match scores.iter_mut().find(|score| score.category == *name) {
                Some(score) => {
                    score.score += weight;
                    if here.0 < score.nearest.0 {
                        score.nearest = here;
                    }
                }
                None => scores.push(CategoryScore {
                    category: name.clone(),
                    score: weight,
                    nearest: here,
                }),
            }
        }
        Evidence {
            radius: neighbours
                .last()
                .map_or(0.0, |last| self.distance_of(last.score)),
            scores,
        }
    }

    fn distance_of(&self, score: f32) -> f32 {
        self.metric.distance_from_score(score, self.dimension)
    }

    /// Recognition of an object from the evidence of one or more of its descriptions: the
    /// category of the greatest mean score.
    pub(super) fn decide<'a>(
        &self,
        sides: impl Iterator<Item = &'a Evidence> + Clone,
        rule: UnknownRule,
    ) -> Recognition {
        let n_sides = sides.clone().count();
        let Some(calibration) = self.calibration.filter(|_| n_sides > 0) else {
            return Recognition::of_nothing();
        };
        let best = best_categories(sides.clone());
        let Some((first, _)) = &best[0] else {
            return Recognition::of_nothing();
        };
        let per_side = (n_sides as f32).recip();
        let radii: f32 = sides.map(|side| side.radius).sum();
        let mean_distance = |sum: &SummedScore| (radii + sum.distance) * per_side;
        let relative = best[0].as_ref().map_or(f32::INFINITY, |(name, sum)| {
            mean_distance(sum) / calibration.spread(self.own_distances(name), self.distances)
        });
        let size = MemorySize {
            n_views: self.categories.get(*first).map_or(0, |one| one.n_views),
            n_categories: self.categories.len(),
        };
        let scores = best.each_ref().map(|entry| match entry {
            Some((_, sum)) => sum.score * per_side,
            None => f32::NEG_INFINITY,
        });
        let (probabilities, unknown) = calibration.probabilities(scores, relative, size);
        let prior = prior_with(rule.novelty_prior(), size.n_categories);
        let known = under_prior(1.0 - unknown, 1.0 - unknown, prior);
        let probabilities = probabilities.map(|one| under_prior(one, 1.0 - unknown, prior));
        let distance = best[0]
            .as_ref()
            .map_or(f32::INFINITY, |(_, sum)| mean_distance(sum));
        let is_known = match rule {
            UnknownRule::FartherThan(threshold) => distance <= threshold,
            UnknownRule::LessProbableThan { probability, .. } => probabilities[0] >= probability,
        };
        let mut probabilities = probabilities.into_iter();
        Recognition {
            label: is_known.then(|| (*first).clone()),
            distance,
            novelty: Some(-probabilities.as_slice()[0].ln()),
            probability: Some(probabilities.as_slice()[0]),
            known_probability: Some(known),
            n_sides,
            nearest: best.map(|entry| {
                let probability = probabilities.next();
                entry.map(|(name, sum)| Neighbour {
                    view: sum.nearest.1,
                    category: name.clone(),
                    distance: sum.nearest.0,
                    probability,
                })
            }),
        }
    }

    fn own_distances(&self, category: &CategoryName) -> DistanceSum {
        let own = self.categories.get(category);
        own.map_or_else(DistanceSum::default, |category| category.spread.distances())
    }
}

/// Categories of the greatest summed scores; ties go to the smaller distance, then to the
/// smaller view id.
fn best_categories<'a>(
    sides: impl Iterator<Item = &'a Evidence>,
) -> [Option<(&'a CategoryName, SummedScore)>; N_NEAREST] {
    let mut sums: BTreeMap<&CategoryName, SummedScore> = BTreeMap::new();
    for side in sides {
        for CategoryScore {
            category,
            score,
            nearest,
        } in &side.scores
        {
            let beyond = nearest.0 - side.radius;
            let sum = sums.entry(category).or_insert(SummedScore {
                score: 0.0,
                distance: 0.0,
                nearest: *nearest,
            });
            sum.score += score;
            sum.distance += beyond;
            if nearest
                .0
                .total_cmp(&sum.nearest.0)
                .then(nearest.1.cmp(&sum.nearest.1))
                .is_lt()
            {
                sum.nearest = *nearest;
            }
        }
    }
    let mut ranked: Vec<_> = sums.into_iter().collect();
    ranked.sort_by(|(_, a), (_, b)| {
        let by_score = b.score.total_cmp(&a.score);
        let by_distance = a.distance.total_cmp(&b.distance);
        by_score
            .then(by_distance)
            .then(a.nearest.1.cmp(&b.nearest.1))
    });
    let mut ranked = ranked.into_iter();
    std::array::from_fn(|_| ranked.next())
}
