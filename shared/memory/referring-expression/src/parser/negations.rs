//! Negations: "not red", "not a vase", "neither a mug nor a bowl".

use super::{CLOSED_WORDS, Draft, Parser};
use crate::expression::RestrictionKind;
use crate::tokens::WordSpan;
use crate::vocabulary::{self, INDEFINITES, NEGATIONS};

impl Parser<'_> {
    /// Reads "not" before another modifier, or before a noun.
    pub(super) fn negation(&mut self, draft: &mut Draft) -> bool {
        let checkpoint = self.checkpoint();
        if draft.is_negated {
            return false;
        }
        let Some(((), span)) = self.take(&NEGATIONS, "a negation") else {
            return false;
        };
        if vocabulary::longest(&INDEFINITES, self.rest()).is_some()
            && self.negated_noun(draft, span)
        {
            return true;
        }
        draft.is_negated = true;
        if self.modifier(draft) {
            return true;
        }
        draft.is_negated = false;
        self.is_noun_ahead() && self.negated_noun(draft, span) || self.restore(&checkpoint)
    }

    /// Reads the noun phrase after "not", and those after "or" and "nor".
    fn negated_noun(&mut self, draft: &mut Draft, span: WordSpan) -> bool {
        let checkpoint = self.checkpoint();
        let Some(phrase) = self.landmark() else {
            return self.restore(&checkpoint);
        };
        draft.is_negated = true;
        draft.has_postmodifier = true;
        Self::restrict(draft, span, RestrictionKind::Is(Box::new(phrase)));
        while matches!(self.next_word(), "or" | "nor") && self.further_exception(draft, span) {}
        true
    }

    /// True before a name, or a word that may be a noun.
    fn is_noun_ahead(&self) -> bool {
        let Some(first) = self.rest().first() else {
            return false;
        };
        let word = first.word.as_str();
        let is_closed = CLOSED_WORDS.contains(&word) || vocabulary::is_word(word);
        self.name_here().is_some() || !is_closed && !vocabulary::is_ordinary(word)
    }
}
