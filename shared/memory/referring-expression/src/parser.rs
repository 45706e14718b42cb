//! Recursive-descent parser from words to a [`ReferringExpression`].
//!
//! It never fails: words that fit nowhere are left over, and the rest is used. Restrictions attach
//! to the nearest noun.

mod between;
mod clauses;
mod extremes;
mod modifiers;
mod negations;
mod nouns;

use crate::expression::{
    Noun, NounPhrase, Quantity, Ranking, RankingKey, ReferringExpression, Restriction,
    RestrictionKind,
};
use crate::names::NameIndex;
use crate::shade::shade;
use crate::tokens::{SpokenWord, WordSpan};
use crate::vocabulary::{self, ACKNOWLEDGEMENTS, JOINTS, WRAPPERS};

/// Deepest nesting of landmarks.
const DEPTH_MAX: usize = 6;

/// Meaning of "thing".
const ANY_OBJECT: &str = "any object";

/// Most attempts to read a landmark, so that the time of a query is bounded.
const LANDMARK_ATTEMPTS_MAX: usize = 32;

/// Words that are never a noun.
const CLOSED_WORDS: [&str; 30] = [
    "and", "or", "the", "a", "an", "of", "to", "at", "for", "from", "with", "without", "than", "i",
    "you", "me", "we", "it", "my", "your", "is", "are", "do", "does", "no", "not", "very", "so",
    "ago", "there",
];

/// Words that open a clause or an attribute after the noun.
const AFTER_NOUN: [&str; 9] = [
    "that", "that's", "which", "who", "whose", "with", "has", "have", "having",
];

/// Syntax tree of a query with the meaning of its words.
#[derive(Debug, Default)]
pub(crate) struct Parse {
    pub(crate) expression: ReferringExpression,
    /// Meanings of words other than nouns; they do not overlap.
    pub(crate) uses: Vec<(WordSpan, String)>,
    /// Words that were accepted but not used, as sentences.
    pub(crate) remarks: Vec<String>,
}

impl Parse {
    /// True if some words of a span are "thing" or the like.
    pub(crate) fn has_generic_noun(&self, span: WordSpan) -> bool {
        let mut uses = self.uses.iter();
        uses.any(|(used, meaning)| span.contains(used.start) && meaning == ANY_OBJECT)
    }
}

/// Parser at a position of the query.
struct Parser<'a> {
    words: &'a [SpokenWord],
    names: &'a NameIndex,
    position: usize,
    depth: usize,
    n_landmark_attempts: usize,
    uses: Vec<(WordSpan, String)>,
    remarks: Vec<String>,
}

/// State to which the parser can return.
struct Checkpoint {
    position: usize,
    n_uses: usize,
    n_remarks: usize,
}

/// Noun phrase that is being read.
#[derive(Default)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "independent facts about what was read, not states of one machine"
)]
struct Draft {
    phrase: NounPhrase,
    has_determiner: bool,
    /// True if a known name or a generic noun was read.
    has_known_noun: bool,
    /// True after a relation, a place or a clause: the noun cannot come any more.
    has_postmodifier: bool,
    /// True after "not": it holds for the next restriction.
    is_negated: bool,
    /// Rank of "second", until it is known from which side.
    ordinal: Option<(usize, WordSpan)>,
}

/// Parses the words of a query.
pub(crate) fn parse(words: &[SpokenWord], names: &NameIndex) -> Parse {
    let mut parser = Parser {
        words,
        names,
        position: 0,
        depth: 0,
        n_landmark_attempts: 0,
        uses: Vec::new(),
        remarks: Vec::new(),
    };
    parser.wrappers();
    let expression = parser.expression();
    parser.uses.sort_by_key(|(span, _)| span.start);
    Parse {
        expression,
        uses: parser.uses,
        remarks: parser.remarks,
    }
}

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a [SpokenWord] {
        self.words.get(self.position..).unwrap_or_default()
    }

    fn next_word(&self) -> &'a str {
        self.rest().first().map_or("", |word| word.word.as_str())
    }

    fn checkpoint(&self) -> Checkpoint {
        Checkpoint {
            position: self.position,
            n_uses: self.uses.len(),
            n_remarks: self.remarks.len(),
        }
    }

    /// Returns to a checkpoint; for the end of an attempt that failed.
    fn restore(&mut self, checkpoint: &Checkpoint) -> bool {
        self.position = checkpoint.position;
        self.uses.truncate(checkpoint.n_uses);
        self.remarks.truncate(checkpoint.n_remarks);
        false
    }

    /// Passes words with a meaning.
    fn pass(&mut self, n_words: usize, meaning: impl Into<String>) -> WordSpan {
        let span = self.pass_silently(n_words);
        if !span.is_empty() {
            self.uses.push((span, meaning.into()));
        }
        span
    }

    /// Passes words whose meaning is found later.
    fn pass_silently(&mut self, n_words: usize) -> WordSpan {
        let start = self.position;
        self.position = (start + n_words).min(self.words.len());
        WordSpan {
            start,
            end: self.position,
        }
    }

    /// Passes the longest phrase of a table, if one stands here.
    fn take<T: Clone>(&mut self, table: &[(&str, T)], meaning: &str) -> Option<(T, WordSpan)> {
        let (value, n_words) = vocabulary::longest(table, self.rest())?;
        let value = value.clone();
        Some((value, self.pass(n_words, meaning)))
    }

    fn has<T>(&self, table: &[(&str, T)]) -> bool {
        vocabulary::longest(table, self.rest()).is_some()
    }

    /// Passes "please, can you find".
    fn wrappers(&mut self) {
        while self.names.longest_at_start(self.rest()).is_none() && !self.is_teaching_ahead() {
            let is_request = self.take(&WRAPPERS, "a request").is_some();
            if !is_request && self.take(&ACKNOWLEDGEMENTS, "politeness").is_none() {
                break;
            }
        }
    }

    /// Reads noun phrases joined by "and" or "or", up to the end of the query.
    fn expression(&mut self) -> ReferringExpression {
        let mut expression = ReferringExpression::default();
        loop {
            expression.phrases.push(self.noun_phrase(true));
            match self.next_word() {
                "" => return expression,
                "or" => {
                    expression.is_alternative = true;
                    self.pass(1, "an alternative");
                }
                _ => {
                    let joint = self.pass(1, "a further object");
                    self.doubt_further_object(&expression, joint);
                }
            }
        }
    }

    /// Remarks that "and the bowl" after "the mug next to the box" may mean a second landmark.
    fn doubt_further_object(&mut self, expression: &ReferringExpression, joint: WordSpan) {
        let last = expression.phrases.last();
        let restriction = last.and_then(|phrase| phrase.restrictions.last());
        let follows_landmark = restriction.is_some_and(|restriction| {
            matches!(&restriction.kind, RestrictionKind::Relation(_, landmark)
                if landmark.span.end == joint.start)
        });
        if follows_landmark {
            let object = self.rest().iter().take(2).map(|word| word.text.as_str());
            let object = object.collect::<Vec<_>>().join(" ");
            self.remarks
                .push(format!("`and {object}` was read as a further object"));
        }
    }

    /// Reads a noun phrase. The outermost one passes over what it does not understand.
    fn noun_phrase(&mut self, is_outermost: bool) -> NounPhrase {
        let mut draft = Draft::default();
        let start = self.position;
        self.determiner(&mut draft);
        while self.position < self.words.len() {
            let is_read = if is_outermost {
                self.part(&mut draft)
            } else {
                self.landmark_part(&mut draft)
            };
            if is_read {
                continue;
            }
            if !is_outermost || self.is_phrase_joined() {
                break;
            }
            self.skip_word(&mut draft);
        }
        draft.phrase.span = WordSpan {
            start,
            end: self.position,
        };
        self.finish(draft)
    }

    /// Passes a word that fits nowhere; an article in the middle has a use.
    fn skip_word(&mut self, draft: &mut Draft) {
        draft.is_negated = false;
        if matches!(self.next_word(), "the" | "a" | "an") {
            self.pass(1, "an article");
        } else {
            self.position += 1;
        }
    }

    /// Reads one part of the outermost phrase.
    fn part(&mut self, draft: &mut Draft) -> bool {
        self.name_or_modifier(draft)
            || self.known_noun(draft)
            || self.take(&ACKNOWLEDGEMENTS, "politeness").is_some()
            || self.joint(draft)
            || self.possessive()
            || self.open_noun(draft)
            || self.joined_modifier(draft)
    }

    /// Reads "that is" or "with". After a relative pronoun or "with" no noun takes the place of the
    /// one before: "the cup with the handle".
    fn joint(&mut self, draft: &mut Draft) -> bool {
        let Some(((), span)) = self.take(&JOINTS, "a joint") else {
            return false;
        };
        let first = span.of(self.words).first();
        let is_after_noun = first.is_some_and(|word| AFTER_NOUN.contains(&word.word.as_str()));
        draft.has_postmodifier |= is_after_noun && draft.phrase.noun != Noun::Anything;
        true
    }

    /// Reads one part of a landmark: joints only before a modifier, so that "and" stays outside.
    fn landmark_part(&mut self, draft: &mut Draft) -> bool {
        if self.name_or_modifier(draft) || self.known_noun(draft) {
            return true;
        }
        if !draft.has_known_noun && self.possessive() {
            return true;
        }
        let checkpoint = self.checkpoint();
        if self.take(&JOINTS, "a joint").is_some() {
            return self.modifier(draft) || self.restore(&checkpoint);
        }
        self.open_noun(draft)
    }

    /// Reads a name that has words of the vocabulary in it, the container of a name, or a modifier.
    fn name_or_modifier(&mut self, draft: &mut Draft) -> bool {
        self.contained_name(draft)
            || self.container_after_name(draft)
            || self.name_before_meanings(draft)
            || self.modifier(draft)
    }

    /// Reads "and left of the box" after another modifier.
    fn joined_modifier(&mut self, draft: &mut Draft) -> bool {
        let checkpoint = self.checkpoint();
        if self.next_word() != "and" {
            return false;
        }
        self.pass(1, "both");
        self.take(&JOINTS, "a joint");
        self.modifier(draft) || self.restore(&checkpoint)
    }

    /// True before "and the box".
    fn is_phrase_joined(&self) -> bool {
        let after = self.rest().get(1..).unwrap_or_default();
        matches!(self.next_word(), "and" | "or")
            && (vocabulary::longest(&vocabulary::DETERMINERS, after).is_some()
                || vocabulary::longest(&vocabulary::NUMERALS, after).is_some()
                || vocabulary::longest(&vocabulary::GENERIC_NOUNS, after).is_some()
                || self.names.longest_at_start(after).is_some()
                || !after.is_empty()
                    && shade(&after[0].word).is_none()
                    && self.names.has_part(&after[..1]))
    }

    /// Reads the noun phrase of a landmark; None if nothing stands here or it is nested too deep.
    fn landmark(&mut self) -> Option<NounPhrase> {
        if self.depth >= DEPTH_MAX || self.n_landmark_attempts >= LANDMARK_ATTEMPTS_MAX {
            return None;
        }
        self.n_landmark_attempts += 1;
        let start = self.position;
        self.depth += 1;
        let phrase = self.noun_phrase(false);
        self.depth -= 1;
        let has_content = phrase.noun != Noun::Anything
            || !phrase.restrictions.is_empty()
            || !phrase.rankings.is_empty()
            || phrase.quantity != Quantity::Open;
        (self.position > start && has_content).then_some(phrase)
    }

    fn restrict(draft: &mut Draft, span: WordSpan, kind: RestrictionKind) -> bool {
        draft.phrase.restrictions.push(Restriction {
            span,
            is_negated: std::mem::take(&mut draft.is_negated),
            kind,
        });
        true
    }

    /// Completes a phrase: an ordinal without a side counts from the left.
    fn finish(&mut self, draft: Draft) -> NounPhrase {
        let mut phrase = draft.phrase;
        if let Some((rank, span)) = draft.ordinal {
            let word = span.text(self.words);
            self.remarks
                .push(format!("`{word}` was counted from the left"));
            phrase.rankings.push(Ranking {
                span,
                key: RankingKey::Leftmost,
                rank,
            });
        }
        phrase
    }
}
