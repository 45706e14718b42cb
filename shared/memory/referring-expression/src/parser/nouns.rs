//! Determiners, numerals and nouns of a phrase.

use super::clauses::AUXILIARIES;
use super::{ANY_OBJECT, CLOSED_WORDS, Draft, Parser};
use crate::compound::is_container;
use crate::expression::{Noun, Quantity};
use crate::names;
use crate::shade::shade;
use crate::tokens::{SpokenWord, WordSpan};
use crate::vocabulary::{
    self, ADJECTIVES, DETERMINERS, GENERIC_NOUNS, LENGTH_UNITS, NUMERALS, POSSESSIVES,
    TEACHING_VERBS, TIME_UNITS,
};

/// Most objects that a number in digits may ask for.
const COUNT_MAX: usize = 1000;

impl Parser<'_> {
    /// Reads "the", "all", "two" at the start of a phrase.
    pub(super) fn determiner(&mut self, draft: &mut Draft) {
        if self.name_here() > Some(1) {
            return;
        }
        let word = self.next_word();
        if !self.is_clause_ahead()
            && let Some((quantity, span)) = self.take(&DETERMINERS, "a determiner")
        {
            draft.has_determiner = true;
            draft.phrase.quantity = quantity;
            if POSSESSIVES.contains(&word) {
                self.remark_possessive(span);
            }
        }
        if self.name_here() > Some(1) {
            return;
        }
        if let Some(count) = self.numeral(draft) {
            draft.has_determiner = true;
            draft.phrase.quantity = match draft.phrase.quantity {
                Quantity::All(_) => Quantity::All(Some(count)),
                _ => Quantity::Exactly(count),
            };
            self.take(&[("of the", ()), ("of", ())], "a determiner");
        }
    }

    fn remark_possessive(&mut self, span: WordSpan) {
        let words = span.text(self.words);
        self.remarks.push(format!(
            "`{words}` was not used: who owns an object is not known"
        ));
    }

    /// Reads "my" inside a phrase: "all my mugs", "the mug that my mother likes".
    pub(super) fn possessive(&mut self) -> bool {
        let is_here = POSSESSIVES.contains(&self.next_word());
        if is_here {
            let span = self.pass(1, "a possessive, not used");
            self.remark_possessive(span);
        }
        is_here
    }

    /// True before "that is": a clause without a noun, and no determiner.
    fn is_clause_ahead(&self) -> bool {
        let second = self.rest().get(1).map_or("", |word| word.word.as_str());
        self.next_word() == "that" && matches!(second, "is" | "are" | "was" | "has" | "i" | "you")
    }

    fn numeral(&mut self, draft: &Draft) -> Option<usize> {
        let (count, n_words) = self.number_here()?;
        let after = self.rest().get(n_words..).unwrap_or_default();
        let is_measure = vocabulary::longest(&LENGTH_UNITS, after).is_some()
            || vocabulary::longest(&TIME_UNITS, after).is_some();
        if is_measure || after.is_empty() {
            return None;
        }
        let is_noun = self.next_word() == "one" && (draft.has_determiner || !self.noun_follows(1));
        if is_noun {
            return None;
        }
        self.pass(n_words, format!("a number: {count}"));
        Some(count)
    }

    fn number_here(&self) -> Option<(usize, usize)> {
        if let Some((count, n_words)) = vocabulary::longest(&NUMERALS, self.rest()) {
            return Some((*count, n_words));
        }
        let count: usize = self.next_word().parse().ok()?;
        (1..=COUNT_MAX).contains(&count).then_some((count, 1))
    }

    /// True if a noun, or an adjective before it, stands some words ahead.
    fn noun_follows(&self, n_words: usize) -> bool {
        let after = self.rest().get(n_words..).unwrap_or_default();
        let Some(first) = after.first() else {
            return false;
        };
        let is_joint = matches!(first.word.as_str(), "and" | "or");
        let color = after.get(usize::from(is_joint));
        color.is_some_and(|word| shade(&word.word).is_some())
            || self.names.longest_at_start(after).is_some()
            || vocabulary::longest(&GENERIC_NOUNS, after).is_some()
            || vocabulary::longest(&ADJECTIVES, after).is_some()
            || self.is_open_word(after)
    }

    /// True if the first of the words may be a noun: a part of a name, or no word of the
    /// vocabulary and no author of a lesson.
    fn is_open_word(&self, words: &[SpokenWord]) -> bool {
        let Some(first) = words.first() else {
            return false;
        };
        let is_closed = vocabulary::is_word(&first.word) || first.word.parse::<f64>().is_ok();
        let after = words.get(1..).unwrap_or_default();
        let is_author = after
            .first()
            .is_some_and(|w| AUXILIARIES.contains(&w.word.as_str()))
            || vocabulary::longest(&TEACHING_VERBS, after).is_some();
        !is_closed && (self.names.has_part(&words[..1]) || !is_author)
    }

    /// Number of words of the known name here.
    ///
    /// A name after adjectives that reaches further than the name they begin is meant instead:
    /// the "tea box" of "green tea box", although "green tea" is a name, too.
    pub(super) fn name_here(&self) -> Option<usize> {
        let words = self.rest();
        let n_words = self.names.longest_at_start(words)?;
        let is_adjective = |word: &SpokenWord| {
            let alone = std::slice::from_ref(word);
            shade(&word.word).is_some() || vocabulary::longest(&ADJECTIVES, alone).is_some()
        };
        let n_adjectives = words.iter().take_while(|word| is_adjective(word)).count();
        let reaches_further = |start: usize| {
            let later = self.names.longest_at_start(&words[start..]);
            later.is_some_and(|n| n > 1 && start + n > n_words)
        };
        let is_overlapped =
            (1..n_words).any(|start| start <= n_adjectives && reaches_further(start));
        (!is_overlapped).then_some(n_words)
    }

    /// True if a name stands here that is no colour of a noun after it.
    pub(super) fn is_name_here(&self) -> bool {
        self.name_here()
            .is_some_and(|n| n > 1 || !self.noun_follows(1))
    }

    /// Reads a known name whose words also have a meaning: of several words, or one that no noun
    /// follows.
    pub(super) fn name_before_meanings(&mut self, draft: &mut Draft) -> bool {
        self.is_name_here() && self.known_noun(draft)
    }

    /// Reads "can of" before "red bull".
    pub(super) fn contained_name(&mut self, draft: &mut Draft) -> bool {
        let words = self.rest();
        let [container, of, ..] = words else {
            return false;
        };
        if draft.has_known_noun || of.word != "of" || !is_container(&container.word) {
            return false;
        }
        let n_articles = words
            .get(2)
            .map_or(0, |w| usize::from(matches!(w.word.as_str(), "the" | "a")));
        let after = words.get(2 + n_articles..).unwrap_or_default();
        let container_words = std::slice::from_ref(container);
        let is_container_known = self.names.has(container_words);
        let is_container_head = self.names.has_head(container_words);
        let has_name = self.names.longest_at_start(after).is_some();
        let has_head = !is_container_head && !after.is_empty() && self.names.has_head(&after[..1]);
        if self.names.longest_at_start(words).is_some_and(|n| n > 1)
            || is_container_known
            || !has_name && !has_head
        {
            return false;
        }
        self.pass_container(2 + n_articles);
        true
    }

    /// Reads "can" after the name "red bull".
    pub(super) fn container_after_name(&mut self, draft: &mut Draft) -> bool {
        let Noun::Category(noun) = draft.phrase.noun else {
            return false;
        };
        let is_after = draft.has_known_noun && noun.end == self.position;
        let is_name_short = noun.end - noun.start < 2;
        if !is_after
            || !is_container(self.next_word())
            || is_name_short && self.name_here().is_some()
        {
            return false;
        }
        draft.phrase.is_plural = names::is_plural(self.next_word());
        self.pass_container(1);
        true
    }

    fn pass_container(&mut self, n_words: usize) {
        let span = self.pass(n_words, "the container of the name");
        let words = span.text(self.words);
        self.remarks.push(format!(
            "`{words}` was not used: of a container only the name is known"
        ));
    }

    /// Reads a known name or a generic noun.
    pub(super) fn known_noun(&mut self, draft: &mut Draft) -> bool {
        if let Some(n_words) = self.name_here() {
            let is_adjacent = matches!(
                draft.phrase.noun,
                Noun::Category(noun) if noun.end == self.position
            );
            let is_first = draft.phrase.noun == Noun::Anything || !draft.has_postmodifier;
            let is_free = !draft.has_known_noun && is_first || is_adjacent;
            if is_free && !self.is_color_here(n_words, draft) {
                self.set_noun(draft, n_words);
                draft.has_known_noun = true;
                return true;
            }
            return false;
        }
        if draft.has_known_noun && draft.phrase.noun == Noun::Anything {
            return false;
        }
        let Some((is_plural, _)) = self.take(&GENERIC_NOUNS, ANY_OBJECT) else {
            return false;
        };
        if !draft.has_known_noun && !draft.has_postmodifier {
            draft.phrase.is_vague = draft.phrase.noun != Noun::Anything;
            draft.phrase.noun = Noun::Anything;
            draft.phrase.is_plural = is_plural;
        }
        draft.has_known_noun = true;
        true
    }

    /// True if a name here is the colour of a noun: "orange mug" where `orange` is a category, too.
    fn is_color_here(&self, n_words: usize, draft: &Draft) -> bool {
        let is_color = n_words == 1 && shade(self.next_word()).is_some();
        is_color && (draft.has_known_noun || self.noun_follows(1))
    }

    /// Reads a word that is no known name as a noun. A later noun takes its place.
    pub(super) fn open_noun(&mut self, draft: &mut Draft) -> bool {
        let word = self.next_word();
        let is_closed = CLOSED_WORDS.contains(&word) || word.parse::<f64>().is_ok();
        if is_closed || draft.has_known_noun || draft.has_postmodifier {
            return false;
        }
        self.set_noun(draft, 1);
        true
    }

    /// Sets the noun; words of a compound that is not known stay together.
    fn set_noun(&mut self, draft: &mut Draft, n_words: usize) {
        let is_name = self.names.has(&self.rest()[..n_words]);
        let mut span = self.pass_silently(n_words);
        if let Noun::Category(previous) = draft.phrase.noun
            && previous.end == span.start
            && !draft.has_known_noun
            && !is_name
        {
            span = WordSpan {
                start: previous.start,
                end: span.end,
            };
        }
        draft.phrase.noun = Noun::Category(span);
        draft.phrase.is_plural = if is_name {
            self.names.is_plural(span.of(self.words))
        } else {
            let last = span.of(self.words).last();
            last.is_some_and(|last| names::is_plural(&last.word))
        };
    }
}
