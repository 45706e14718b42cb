//! "Between" with its two landmarks: "between the red and the blue mug", "between the boxes".

use super::{Draft, Parser};
use crate::expression::{ColorPhrase, Noun, NounPhrase, Quantity, RestrictionKind};
use crate::vocabulary::BETWEEN;

impl Parser<'_> {
    /// Reads "between the box and the mug".
    pub(super) fn between(&mut self, draft: &mut Draft) -> bool {
        let checkpoint = self.checkpoint();
        let is_negated = draft.is_negated;
        let Some(((), span)) = self.take(&BETWEEN, "a relation") else {
            return false;
        };
        let Some(landmarks) = self.two_landmarks() else {
            return self.restore(&checkpoint);
        };
        draft.is_negated = is_negated;
        draft.has_postmodifier = true;
        Self::restrict(draft, span, RestrictionKind::Between(Box::new(landmarks)))
    }

    fn two_landmarks(&mut self) -> Option<[NounPhrase; 2]> {
        let mut first = self.landmark()?;
        if self.next_word() == "and" {
            self.pass(1, "the second landmark");
            let second = self.landmark()?;
            inherit_noun(&mut first, &second);
            return Some([first, second]);
        }
        let is_several = first.is_plural || matches!(first.quantity, Quantity::Exactly(n) if n > 1);
        let is_pair = is_several || matches!(first.quantity, Quantity::All(_));
        is_pair.then(|| one_of_each_color(&first).unwrap_or_else(|| [first.clone(), first]))
    }
}

/// Gives "the red" of "the red and the blue mug" the noun that follows.
fn inherit_noun(first: &mut NounPhrase, second: &NounPhrase) {
    let is_elliptic = first.noun == Noun::Anything
        && first.restrictions.last().is_some_and(|restriction| {
            restriction.span.end == first.span.end
                && matches!(
                    restriction.kind,
                    RestrictionKind::Color(_) | RestrictionKind::Size(..)
                )
        });
    if is_elliptic {
        first.noun = second.noun;
    }
}

/// "The red mug" and "the blue mug" for "the red and blue mugs".
fn one_of_each_color(phrase: &NounPhrase) -> Option<[NounPhrase; 2]> {
    let position = phrase.restrictions.iter().position(|restriction| {
        matches!(&restriction.kind, RestrictionKind::Color(ColorPhrase::All(shades)) if shades.len() == 2)
    })?;
    let RestrictionKind::Color(ColorPhrase::All(shades)) = &phrase.restrictions[position].kind
    else {
        return None;
    };
    let of_color = |index: usize| {
        let mut one = phrase.clone();
        one.is_plural = false;
        one.quantity = Quantity::The;
        one.restrictions[position].kind =
            RestrictionKind::Color(ColorPhrase::Any(vec![shades[index]]));
        one
    };
    Some([of_color(0), of_color(1)])
}
