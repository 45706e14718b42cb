//! Sizes of objects: relative to one another, to a landmark, and measured.

use super::{Grounder, Judgement, MATCH_MIN, Rating};
use crate::expression::NounPhrase;
use crate::size::{Bound, Degree, Dimension, comparative_score, measure_score, relative_score};
use crate::tokens::WordSpan;

/// Score of objects that hardly differ in size.
const EQUAL_SCORE: f64 = 0.5;

/// Score below which a size is doubtful.
const CLEAR_SCORE: f64 = 0.6;

impl Grounder<'_> {
    fn values(&self, dimension: Dimension) -> Vec<f64> {
        self.geometries.iter().map(|g| dimension.of(g)).collect()
    }

    /// Judges "big" among the objects that fit the rest, or among all if only one does.
    pub(super) fn judge_size(
        &self,
        dimension: Dimension,
        degree: Degree,
        ratings: &[Rating],
    ) -> Vec<Judgement> {
        let values = self.values(dimension);
        let fitting = values
            .iter()
            .zip(ratings)
            .filter(|(_, r)| r.score >= MATCH_MIN);
        let fitting: Vec<f64> = fitting.map(|(value, _)| *value).collect();
        let is_alone = fitting.len() < 2;
        let all: Vec<f64> = values
            .iter()
            .zip(self.world.objects)
            .filter(|(_, object)| !object.is_gone())
            .map(|(value, _)| *value)
            .collect();
        let others = if is_alone { &all } else { &fitting };
        let adjective = dimension.adjective(degree);
        let judge = |(index, value): (usize, &f64)| {
            let relative = relative_score(*value, others, degree);
            // An object without rivals is probably meant, whatever its size.
            let floor = if is_alone { 0.4 } else { 0.0 };
            let score = relative.unwrap_or(EQUAL_SCORE);
            let track = self.track(index);
            Judgement::new(
                floor + (1.0 - floor) * score,
                format!("is {adjective}"),
                format!("is not {adjective}"),
            )
            .doubt_if(relative.is_none(), || {
                format!("track {track} and the others hardly differ in size")
            })
            .doubt_if(relative.is_some_and(|score| score < CLEAR_SCORE), || {
                format!("track {track} is not clearly {adjective}")
            })
        };
        values.iter().enumerate().map(judge).collect()
    }

    pub(super) fn judge_size_than(
        &mut self,
        (dimension, degree): (Dimension, Degree),
        other: &NounPhrase,
        span: WordSpan,
    ) -> Option<Vec<Judgement>> {
        let comparison = format!("{} than", dimension.comparative(degree));
        let values = self.values(dimension);
        let score = |index: usize, landmark: usize| {
            comparative_score(values[index], values[landmark], degree)
        };
        self.judge_by_landmark(other, span, &comparison, score)
    }

    pub(super) fn judge_measure(
        &self,
        dimension: Dimension,
        bound: Bound,
        measure_m: f64,
    ) -> Vec<Judgement> {
        let judge = |(index, value_m): (usize, f64)| {
            let score = measure_score(value_m, bound, measure_m);
            let text = format!("measures {:.0} cm", 100.0 * value_m);
            let track = self.track(index);
            Judgement::new(score, text.clone(), text.clone())
                .doubt_if(score < 0.8, || format!("track {track} {text}"))
        };
        self.values(dimension)
            .into_iter()
            .enumerate()
            .map(judge)
            .collect()
    }
}
