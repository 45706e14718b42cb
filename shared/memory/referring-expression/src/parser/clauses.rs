//! Clauses of teaching and seeing, and their times: "that Anna taught you yesterday".

use super::{CLOSED_WORDS, Draft, Parser};
use crate::expression::{LessonAuthor, RestrictionKind};
use crate::shade::shade;
use crate::time_phrase::TimePhrase;
use crate::tokens::{SpokenWord, WordSpan};
use crate::vocabulary::{
    self, COUNTED_TIMES, GENERIC_NOUNS, JOINTS, NUMERALS, TEACHING_VERBS, TIME_UNITS, TIMES, WITHIN,
};

/// Auxiliaries between an author and the verb.
pub(super) const AUXILIARIES: [&str; 6] = ["have", "has", "had", "just", "did", "already"];

/// Authors that are no names.
const AUTHORS: [(&str, LessonAuthor); 8] = [
    ("i", LessonAuthor::Speaker),
    ("i've", LessonAuthor::Speaker),
    ("me", LessonAuthor::Speaker),
    ("we", LessonAuthor::Anyone),
    ("somebody", LessonAuthor::Anyone),
    ("someone", LessonAuthor::Anyone),
    ("they", LessonAuthor::Anyone),
    ("people", LessonAuthor::Anyone),
];

/// Verbs of seeing, before a time.
const SEEING_VERBS: [(&str, ()); 5] = [
    ("seen", ()),
    ("you saw", ()),
    ("you have seen", ()),
    ("you last saw", ()),
    ("last seen", ()),
];

/// Verbs of appearing, before a time.
const APPEARING_VERBS: [(&str, ()); 5] = [
    ("appeared", ()),
    ("came", ()),
    ("arrived", ()),
    ("first seen", ()),
    ("you first saw", ()),
];

impl Parser<'_> {
    /// Reads one clause.
    pub(super) fn clause(&mut self, draft: &mut Draft) -> bool {
        self.teaching(draft)
            || self.passive_teaching(draft)
            || self.timed(draft, &SEEING_VERBS, RestrictionKind::Seen)
            || self.timed(draft, &APPEARING_VERBS, RestrictionKind::Appeared)
            || self.bare_time(draft)
    }

    /// True before "I showed you" and "what Anna taught you", so that no request is read there.
    pub(super) fn is_teaching_ahead(&self) -> bool {
        self.author_and_verb().is_some_and(|(_, _, n_words)| {
            let verb = self.rest().get(n_words..).unwrap_or_default();
            vocabulary::longest(&TEACHING_VERBS, verb).is_some_and(|((), n_words)| n_words > 1)
        })
    }

    /// Author here, the number of its words, and of the words before the verb.
    fn author_and_verb(&self) -> Option<(LessonAuthor, usize, usize)> {
        let words = self.rest();
        let author = self.author_here(words)?;
        let is_auxiliary = |word: &&SpokenWord| AUXILIARIES.contains(&word.word.as_str());
        let n_words = 1 + words[1..].iter().take_while(is_auxiliary).count();
        let has_verb = vocabulary::longest(&TEACHING_VERBS, &words[n_words..]).is_some();
        has_verb.then_some((author, 1, n_words))
    }

    fn author_here(&self, words: &[SpokenWord]) -> Option<LessonAuthor> {
        if let Some((author, 1)) = vocabulary::longest(&AUTHORS, words) {
            return Some(*author);
        }
        let word = words.first()?.word.as_str();
        let is_name = !CLOSED_WORDS.contains(&word)
            && !AUXILIARIES.contains(&word)
            && shade(word).is_none()
            && vocabulary::longest(&GENERIC_NOUNS, words).is_none()
            && vocabulary::longest(&JOINTS, words).is_none()
            && vocabulary::longest(&TEACHING_VERBS, words).is_none()
            && self.names.longest_at_start(words).is_none();
        is_name.then_some(LessonAuthor::Named(WordSpan {
            start: self.position,
            end: self.position + 1,
        }))
    }

    /// Reads "I showed you yesterday".
    fn teaching(&mut self, draft: &mut Draft) -> bool {
        let Some((author, n_author, n_before_verb)) = self.author_and_verb() else {
            return false;
        };
        let verb = self.rest().get(n_before_verb..).unwrap_or_default();
        let n_verb = vocabulary::longest(&TEACHING_VERBS, verb).map_or(0, |((), n)| n);
        let after = verb.get(n_verb..).unwrap_or_default();
        let is_passive = after.first().is_some_and(|word| word.word == "by");
        // "The toy taught yesterday" has no author.
        let is_noun = matches!(author, LessonAuthor::Named(_))
            && n_verb == 1
            && draft.has_determiner
            && !draft.has_known_noun;
        if is_passive || is_noun {
            return false;
        }
        let start = self.position;
        self.pass(n_author, "the author of a lesson");
        self.pass(n_before_verb - n_author, "a joint");
        self.pass(n_verb, "a lesson");
        self.lesson(draft, author, start)
    }

    /// Reads "taught by Anna", "shown yesterday".
    fn passive_teaching(&mut self, draft: &mut Draft) -> bool {
        let checkpoint = self.checkpoint();
        let start = self.position;
        if self.take(&TEACHING_VERBS, "a lesson").is_none() {
            return false;
        }
        if self.next_word() == "by" {
            self.pass(1, "the author of a lesson");
            let Some(author) = self.author_here(self.rest()) else {
                return self.restore(&checkpoint);
            };
            self.pass(1, "the author of a lesson");
            return self.lesson(draft, author, start);
        }
        if self.has_time() {
            return self.lesson(draft, LessonAuthor::Anyone, start);
        }
        self.restore(&checkpoint)
    }

    fn lesson(&mut self, draft: &mut Draft, author: LessonAuthor, start: usize) -> bool {
        let time = self.time();
        let span = WordSpan {
            start,
            end: self.position,
        };
        draft.has_postmodifier = true;
        Self::restrict(draft, span, RestrictionKind::Taught(author, time))
    }

    fn timed(
        &mut self,
        draft: &mut Draft,
        verbs: &[(&str, ())],
        kind: fn(TimePhrase) -> RestrictionKind,
    ) -> bool {
        let checkpoint = self.checkpoint();
        let Some(((), span)) = self.take(verbs, "a view") else {
            return false;
        };
        let Some(time) = self.time() else {
            return self.restore(&checkpoint);
        };
        draft.has_postmodifier = true;
        Self::restrict(draft, span, kind(time))
    }

    /// Reads "yesterday" alone as the time of a view.
    fn bare_time(&mut self, draft: &mut Draft) -> bool {
        let start = self.position;
        let Some(time) = self.time() else {
            return false;
        };
        let span = WordSpan {
            start,
            end: self.position,
        };
        draft.has_postmodifier = true;
        Self::restrict(draft, span, RestrictionKind::Seen(time))
    }

    fn has_time(&mut self) -> bool {
        let checkpoint = self.checkpoint();
        let has_time = self.time().is_some();
        self.restore(&checkpoint);
        has_time
    }

    /// Reads a time.
    fn time(&mut self) -> Option<TimePhrase> {
        let checkpoint = self.checkpoint();
        if let Some((time, _)) = self.take(&TIMES, "a time") {
            return Some(time);
        }
        let is_within = self.take(&WITHIN, "a time").is_some();
        let time = self.counted_time(is_within);
        if time.is_none() {
            self.restore(&checkpoint);
        }
        time
    }

    /// Reads "two minutes ago", or "two minutes" after "in the last".
    fn counted_time(&mut self, is_within: bool) -> Option<TimePhrase> {
        let number = if let Ok(number) = self.next_word().parse::<f64>() {
            self.pass(1, "a time");
            number
        } else if let Some((number, _)) = self.take(&COUNTED_TIMES, "a time") {
            number
        } else if let Some((number, _)) = self.take(&NUMERALS, "a time") {
            number as f64
        } else if is_within {
            1.0
        } else {
            return None;
        };
        let (unit, _) = self.take(&TIME_UNITS, "a time")?;
        if is_within {
            return Some(TimePhrase::Within(number, unit));
        }
        self.take(&[("ago", ()), ("earlier", ()), ("before", ())], "a time")?;
        Some(TimePhrase::Ago(number, unit))
    }
}
