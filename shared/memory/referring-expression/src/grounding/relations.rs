//! Relations to landmarks, places of the table, and identity.

use super::{Grounder, Judgement, Landmark};
use crate::expression::{NounPhrase, Quantity};
use crate::relation::{Relation, TablePlace, between_score};
use crate::tokens::WordSpan;

/// Score below which a relation is doubtful.
const CLEAR_SCORE: f64 = 0.6;

/// Reason why a projective relation is not judged.
const NO_VIEW: &str = "the pose of the camera is not known";

impl Grounder<'_> {
    pub(super) fn judge_relation(
        &mut self,
        relation: Relation,
        landmark: &NounPhrase,
        span: WordSpan,
    ) -> Option<Vec<Judgement>> {
        if relation.needs_view() && self.view.is_none() {
            // The noun of the landmark is understood all the same.
            self.rate(landmark);
            self.ignore(span, NO_VIEW);
            return None;
        }
        let view = self.view;
        let geometries = self.geometries.clone();
        let score = |index: usize, landmark: usize| {
            relation.score(&geometries[index], &geometries[landmark], view.as_ref())
        };
        self.judge_by_landmark(landmark, span, relation.word(), score)
    }

    /// Judges all objects by their best landmark.
    pub(super) fn judge_by_landmark(
        &mut self,
        phrase: &NounPhrase,
        span: WordSpan,
        relation: &str,
        score: impl Fn(usize, usize) -> f64,
    ) -> Option<Vec<Judgement>> {
        let landmarks = self.landmarks_or_ignore(phrase, span)?;
        let text = self.text(phrase.span);
        let n_competing = n_competing(phrase, &landmarks);
        let judge = |index: usize| {
            let others = landmarks.iter().filter(|landmark| landmark.index != index);
            let scored = others.map(|landmark| (landmark, score(index, landmark.index)));
            let best = scored.max_by(|a, b| (a.0.weight * a.1).total_cmp(&(b.0.weight * b.1)));
            let Some((landmark, score)) = best else {
                return no_landmark(&text, !landmarks.is_empty());
            };
            let (track, other) = (self.track(index), self.track(landmark.index));
            let mut judgement = Judgement::new(
                landmark.weight * score,
                format!("is {relation} track {other}"),
                format!("is not {relation} `{text}`"),
            )
            .doubt_if(n_competing > 1, || {
                format!("{n_competing} objects fit `{text}`; track {other} was taken")
            })
            .doubt_if(score < CLEAR_SCORE, || {
                format!("track {track} is only roughly {relation} `{text}`")
            });
            judgement.doubts.extend(landmark.doubts.iter().cloned());
            judgement
        };
        Some((0..self.geometries.len()).map(judge).collect())
    }

    pub(super) fn judge_between(
        &mut self,
        phrases: &[NounPhrase; 2],
        span: WordSpan,
    ) -> Option<Vec<Judgement>> {
        let [first, second] = phrases
            .each_ref()
            .map(|phrase| self.landmarks_or_ignore(phrase, span));
        let (first, second) = (first?, second?);
        let is_pair = phrases[0] == phrases[1];
        let text = if is_pair {
            self.text(phrases[0].span)
        } else {
            let texts = phrases.each_ref().map(|phrase| self.text(phrase.span));
            texts.join("` and `")
        };
        let judge = |index: usize| {
            let mut best: Option<(f64, &Landmark, &Landmark)> = None;
            for one in first.iter().filter(|landmark| landmark.index != index) {
                for other in second
                    .iter()
                    .filter(|l| l.index != index && l.index != one.index)
                {
                    let ends = [&self.geometries[one.index], &self.geometries[other.index]];
                    let score = between_score(&self.geometries[index], ends);
                    let score = score * one.weight * other.weight;
                    if best.is_none_or(|(least, ..)| score > least) {
                        best = Some((score, one, other));
                    }
                }
            }
            let Some((score, one, other)) = best else {
                return no_landmark(&text, !first.is_empty() && !second.is_empty());
            };
            let (track, ends) = (self.track(index), [one, other].map(|l| self.track(l.index)));
            let fit = format!("between tracks {} and {}", ends[0], ends[1]);
            let n_competing = if is_pair {
                first.len().saturating_sub(1)
            } else {
                n_competing(&phrases[0], &first).max(n_competing(&phrases[1], &second))
            };
            let mut judgement = Judgement::new(
                score,
                format!("is {fit}"),
                format!("is not between `{text}`"),
            )
            .doubt_if(n_competing > 1, || {
                format!(
                    "several objects fit `{text}`; tracks {} and {} were taken",
                    ends[0], ends[1]
                )
            })
            .doubt_if(score < CLEAR_SCORE, || {
                format!("track {track} is only roughly {fit}")
            });
            judgement
                .doubts
                .extend(one.doubts.iter().chain(&other.doubts).cloned());
            judgement
        };
        Some((0..self.geometries.len()).map(judge).collect())
    }

    pub(super) fn judge_place(
        &mut self,
        place: TablePlace,
        span: WordSpan,
    ) -> Option<Vec<Judgement>> {
        let holds_for_all = place == TablePlace::Anywhere;
        let Some(view) = self.view else {
            if !holds_for_all {
                self.ignore(span, NO_VIEW);
            }
            return None;
        };
        let present = self.world.objects.iter().zip(&self.geometries);
        let present: Vec<_> = present
            .filter(|(object, _)| !object.is_gone())
            .map(|(_, geometry)| *geometry)
            .collect();
        let judge = |index: usize| {
            let is_on_table = !self.world.objects[index].is_gone();
            let score = if holds_for_all {
                f64::from(u8::from(is_on_table))
            } else {
                place.score(&self.geometries[index], &present, &view)
            };
            let words = place.word();
            let track = self.track(index);
            let fit = if holds_for_all {
                String::new()
            } else {
                format!("is {words}")
            };
            Judgement::new(score, fit, format!("is not {words}"))
                .doubt_if(score < CLEAR_SCORE, || {
                    format!("track {track} is not clearly {words}")
                })
        };
        Some((0..self.geometries.len()).map(judge).collect())
    }

    /// Judges the identity with a phrase, for exceptions.
    pub(super) fn judge_identity(
        &mut self,
        phrase: &NounPhrase,
        span: WordSpan,
    ) -> Option<Vec<Judgement>> {
        let landmarks = self.landmarks_or_ignore(phrase, span)?;
        let text = self.text(phrase.span);
        if landmarks.is_empty() {
            self.doubt(format!("nothing here fits `{text}`"));
        }
        let judge = |index: usize| {
            let same = landmarks.iter().find(|landmark| landmark.index == index);
            let score = same.map_or(0.0, |landmark| landmark.weight);
            let mut judgement = Judgement::new(score, format!("is `{text}`"), String::new());
            judgement
                .doubts
                .extend(same.into_iter().flat_map(|l| l.doubts.clone()));
            judgement
        };
        Some((0..self.geometries.len()).map(judge).collect())
    }

    /// Landmarks of a phrase; if its words are not understood, the relation is ignored.
    pub(super) fn landmarks_or_ignore(
        &mut self,
        phrase: &NounPhrase,
        span: WordSpan,
    ) -> Option<Vec<Landmark>> {
        let landmarks = self.landmarks(phrase);
        if landmarks.is_none() {
            self.ignore(span, "the object after it was not understood");
        }
        landmarks
    }
}

/// Number of landmarks that compete, if the phrase means one.
fn n_competing(phrase: &NounPhrase, landmarks: &[Landmark]) -> usize {
    if !phrase.wants_one() || phrase.quantity == Quantity::Any {
        return 0;
    }
    let competes = |landmark: &&Landmark| landmark.weight >= super::COMPETING_SHARE;
    landmarks.iter().filter(competes).count()
}

fn no_landmark(text: &str, is_object_itself: bool) -> Judgement {
    if is_object_itself {
        Judgement::new(0.0, String::new(), format!("is itself `{text}`"))
    } else {
        Judgement::new(
            0.0,
            String::new(),
            format!("has no landmark: nothing here fits `{text}`"),
        )
        .doubt_if(true, || format!("nothing here fits `{text}`"))
    }
}
