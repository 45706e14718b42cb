//! Score of telling new objects from new sides of known objects, among what is unknown.

use crate::novelty_score::area_under_roc;
use crate::recogniser::Answer;
use serde::Serialize;

/// Accuracy of "new object or new side?" over the questions that the live rule answers with
/// "unknown".
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NewSideScore {
    /// Number of unknown questions about objects that were never taught.
    pub n_new_objects: usize,
    /// Number of unknown questions about taught objects, seen from a side that was not.
    pub n_new_sides: usize,
    /// Area under the ROC curve of the novelty: probability that a new object has a greater one
    /// than a new side.
    pub auroc: f64,
    /// Share of the new objects that are told as such.
    pub new_objects_told: f64,
    /// Share of the new sides that are told as such.
    pub new_sides_told: f64,
    /// Share of the new sides whose best category is right.
    pub new_sides_named: f64,
}

/// Answer to a question about a taught object with `true` if its best category is right.
pub type NamedAnswer = (Answer, bool);

impl NewSideScore {
    /// Score of the answers to questions about new objects and about new sides. Unknown is what is
    /// less probably of its best category than `known_probability_min`; `is_new_object` is the
    /// rule under test, given the probability of that category. `None` without unknown questions of
    /// both kinds.
    pub fn of(
        objects: &[Answer],
        sides: &[NamedAnswer],
        known_probability_min: f32,
        is_new_object: impl Fn(f32) -> bool,
    ) -> Option<Self> {
        let is_unknown = |answer: &Answer| answer.is_unknown(known_probability_min);
        let objects: Vec<&Answer> = objects.iter().filter(|answer| is_unknown(answer)).collect();
        let sides: Vec<&NamedAnswer> = sides.iter().filter(|side| is_unknown(&side.0)).collect();
        if objects.is_empty() || sides.is_empty() {
            return None;
        }
        let told = |answer: &Answer| is_new_object(answer.probability.unwrap_or(0.0));
        let share = |n: usize, all: usize| n as f64 / all as f64;
        let n_told = objects.iter().filter(|answer| told(answer)).count();
        let n_sides_told = sides.iter().filter(|side| !told(&side.0)).count();
        let n_named = sides.iter().filter(|side| side.1).count();
        Some(Self {
            n_new_objects: objects.len(),
            n_new_sides: sides.len(),
            auroc: area_under_roc(
                objects.iter().map(|answer| answer.novelty),
                sides.iter().map(|side| side.0.novelty),
            ),
            new_objects_told: share(n_told, objects.len()),
            new_sides_told: share(n_sides_told, sides.len()),
            new_sides_named: share(n_named, sides.len()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(probability: f32, known_probability: f32) -> Answer {
        Answer {
            category: Some(1),
            distance: 1.0,
            novelty: -probability.ln(),
            probability: Some(probability),
            known_probability: Some(known_probability),
            best: [None; 3],
        }
    }

    #[test]
    fn only_unknown_questions_count() {
        let objects = [answer(0.1, 0.2), answer(0.3, 0.5), answer(0.9, 0.95)];
        let sides = [
            (answer(0.4, 0.6), true),
            (answer(0.2, 0.3), false),
            (answer(0.8, 0.9), true),
        ];
        let score = NewSideScore::of(&objects, &sides, 0.75, |p| p < 0.25).unwrap();
        assert_eq!((score.n_new_objects, score.n_new_sides), (2, 2));
        // Of four pairs only 0.3 against 0.2 is in the wrong order.
        assert_eq!(score.auroc, 0.75);
        assert_eq!((score.new_objects_told, score.new_sides_told), (0.5, 0.5));
        assert_eq!(score.new_sides_named, 0.5);
        assert_eq!(
            NewSideScore::of(&objects, &sides[2..], 0.75, |_| true),
            None
        );
        assert_eq!(NewSideScore::of(&[], &sides, 0.75, |_| true), None);
    }
}
