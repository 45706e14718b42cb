//! Referring expression comprehension: from a query to an answer.

use std::collections::BTreeSet;

use crate::answer::{Answer, Match};
use crate::answer_text;
use crate::empty_answer::reason;
use crate::error::Error;
use crate::expression::{Noun, NounPhrase, Quantity};
use crate::grounding::{COMPETING_SHARE, Grounder, Grounding, MATCH_MIN, Notes, Rating};
use crate::lexicon::Lexicon;
use crate::names::NameIndex;
use crate::parser::{Parse, parse};
use crate::spelling::{Spelling, corrected};
use crate::time_phrase::duration_text;
use crate::tokens::{SpokenWord, WordSpan, tokenize};
use crate::word_account::{UseOfWords, account};
use crate::world::{Presence, QueryWorld, WorldObject};

/// Most characters of a query.
pub const QUERY_CHARACTERS_MAX: usize = 400;

/// Score below which an object without any other doubt is doubtful.
const CLEAR_SCORE: f64 = 0.6;

/// Remark of an answer without a lexicon.
const SYNONYMS_OFF: &str =
    "synonyms are off: WordNet is not installed (apt-get install wordnet-base)";

/// Objects of a phrase that was grounded.
pub(crate) struct Selection {
    /// Words of the phrase.
    pub(crate) text: String,
    pub(crate) matches: Vec<Match>,
    pub(crate) wants_one: bool,
    /// Number of objects that fit.
    pub(crate) n_fitting: usize,
    /// Reason why nothing fits.
    pub(crate) reason: Option<String>,
    /// Sentence about what may be said instead of words that were not understood.
    pub(crate) advice: Option<String>,
}

/// Most names of objects that an advice gives as examples.
const EXAMPLES_MAX: usize = 3;

impl Selection {
    /// No objects, for a phrase of which too little was understood.
    fn not_understood(phrase: &NounPhrase, world: &QueryWorld<'_>, text: String) -> Self {
        let present = world.objects.iter().filter(|object| !object.is_gone());
        let names: BTreeSet<&str> = present.filter_map(WorldObject::best_name).collect();
        let examples: Vec<&str> = names.into_iter().take(EXAMPLES_MAX).collect();
        let name = match examples.as_slice() {
            [] => "a name that was taught".to_owned(),
            [one] => format!("a name that was taught, such as `{one}`"),
            [first @ .., last] => {
                let first = first.join("`, `");
                format!("a name that was taught, such as `{first}` or `{last}`")
            }
        };
        Self {
            text,
            matches: Vec::new(),
            wants_one: phrase.wants_one(),
            n_fitting: 0,
            reason: None,
            advice: Some(format!(
                "Say {name}, or a colour, a size or a place of the object."
            )),
        }
    }
}

/// Finds the objects to which an English expression refers.
///
/// Words that are not understood are listed, and the rest is used. Each match carries its doubts.
/// Without a lexicon, only names that were taught and everyday synonyms are understood.
///
/// # Errors
///
/// If the query has no word, or more than [`QUERY_CHARACTERS_MAX`] characters.
pub fn find(
    query: &str,
    world: &QueryWorld<'_>,
    lexicon: Option<&dyn Lexicon>,
) -> Result<Answer, Error> {
    let written = words_of(query)?;
    let names = name_index(world);
    let spelling = corrected(&written, &names, &people(world), lexicon);
    let words = spelling.words.as_slice();
    let parse = parse(words, &names);
    let mut grounder = Grounder::new(words, world, lexicon);
    let phrases = parse.expression.phrases.iter();
    let grounded: Vec<(&NounPhrase, Grounding)> = phrases
        .map(|phrase| (phrase, grounder.rate_outermost(phrase)))
        .collect();
    let notes = grounder.into_notes();
    let use_of_words = account(&spelling, &parse, &notes);
    let read = readings(&spelling, &use_of_words);
    let remarks: Vec<String> = parse.remarks.iter().cloned().chain(read).collect();
    let general = general_doubts(&remarks, &notes, &use_of_words.not_understood);
    let select_or_ask = |(phrase, grounding): (&NounPhrase, Grounding)| {
        let text = phrase.span.text(words);
        if is_understood(phrase, &parse, &notes, &use_of_words) {
            let reason = reason(phrase, &grounding, &notes, world, words);
            Selection {
                reason,
                ..select(phrase, grounding, world, text)
            }
        } else {
            Selection::not_understood(phrase, world, text)
        }
    };
    let selections: Vec<Selection> = grounded
        .into_iter()
        .map(select_or_ask)
        .map(|selection| with_doubts(selection, &general))
        .collect();
    let is_alternative = parse.expression.is_alternative;
    let sentence = answer_text::sentence(&selections, &general, is_alternative);
    let sentence = if lexicon.is_none() && notes.wants_synonyms {
        format!("{sentence} Note: {SYNONYMS_OFF}.")
    } else {
        sentence
    };
    let wants_one = match selections.as_slice() {
        [one] => one.wants_one,
        _ => is_alternative,
    };
    Ok(Answer {
        matches: merged(selections),
        wants_one,
        understood: use_of_words.understood,
        not_understood: use_of_words.not_understood,
        remarks: with_lexicon_remark(remarks, lexicon.is_none()),
        sentence,
    })
}

/// Words of a query of a usable length.
fn words_of(query: &str) -> Result<Vec<SpokenWord>, Error> {
    let n_characters = query.chars().count();
    if n_characters > QUERY_CHARACTERS_MAX {
        return Err(Error::LongQuery {
            n_characters,
            n_most: QUERY_CHARACTERS_MAX,
        });
    }
    let words = tokenize(query);
    if words.is_empty() {
        return Err(Error::EmptyQuery);
    }
    Ok(words)
}

/// People who taught, or who ask.
fn people<'a>(world: &QueryWorld<'a>) -> Vec<&'a str> {
    let authors = world.lessons.iter().map(|lesson| lesson.author.as_str());
    let distinct: BTreeSet<&str> = authors.chain(world.speaker).collect();
    distinct.into_iter().collect()
}

/// True if enough of a phrase was understood to choose objects by it: its noun, or a restriction
/// where "thing" or no noun stands. "Things" or "all" is enough, too, if every word was understood.
fn is_understood(
    phrase: &NounPhrase,
    parse: &Parse,
    notes: &Notes,
    use_of_words: &UseOfWords,
) -> bool {
    let is_used = |span: WordSpan| !notes.ignored.contains(&span);
    if let Noun::Category(span) = phrase.noun {
        return is_used(span);
    }
    let mut positions = phrase.span.positions();
    let is_whole = positions.all(|at| !use_of_words.positions_not_understood.contains(&at));
    let names_all = matches!(phrase.quantity, Quantity::All(_) | Quantity::Exactly(_))
        || parse.has_generic_noun(phrase.span);
    let has_restriction = phrase
        .restrictions
        .iter()
        .any(|one| is_used(one.span) && (is_whole || one.kind.excludes_objects()));
    let has_ranking = phrase.rankings.iter().any(|ranking| is_used(ranking.span));
    is_whole && names_all || has_restriction || has_ranking
}

fn name_index(world: &QueryWorld<'_>) -> NameIndex {
    let of_objects = world.objects.iter().flat_map(|object| &object.names);
    let names = of_objects.map(|(name, _)| name).chain(world.taught_names);
    NameIndex::new(names.map(String::as_str))
}

/// Doubts that concern every match.
fn general_doubts(remarks: &[String], notes: &Notes, not_understood: &[String]) -> Vec<String> {
    let mut doubts = notes.doubts.clone();
    doubts.extend(remarks.iter().cloned());
    match not_understood {
        [] => {}
        [word] => doubts.push(format!("the word `{word}` was not understood")),
        words => doubts.push(format!(
            "the words `{}` were not understood",
            words.join("`, `")
        )),
    }
    doubts
}

/// Remarks about misspelt words. The reading of a word that is not understood all the same is none.
fn readings(spelling: &Spelling, use_of_words: &UseOfWords) -> Vec<String> {
    let is_used = |position: &usize| {
        !spelling.corrected.contains(position)
            || !use_of_words.positions_not_understood.contains(position)
    };
    let remarks = spelling.remarks.iter();
    remarks
        .filter(|(position, _)| is_used(position))
        .map(|(_, remark)| remark.clone())
        .collect()
}

fn with_lexicon_remark(mut remarks: Vec<String>, is_without_lexicon: bool) -> Vec<String> {
    if is_without_lexicon {
        remarks.push(SYNONYMS_OFF.to_owned());
    }
    remarks
}

/// Chooses the objects of a phrase by its number.
fn select(
    phrase: &NounPhrase,
    grounding: Grounding,
    world: &QueryWorld<'_>,
    text: String,
) -> Selection {
    let ratings = grounding.ratings;
    let mut fitting: Vec<(usize, Rating)> = ratings.into_iter().enumerate().collect();
    fitting.retain(|(_, rating)| rating.score >= MATCH_MIN);
    fitting.sort_by(|a, b| {
        let by_score = b.1.score.total_cmp(&a.1.score);
        by_score.then(
            world.objects[a.0]
                .track_id
                .cmp(&world.objects[b.0].track_id),
        )
    });
    let n_fitting = fitting.len();
    let best = fitting.first().map_or(0.0, |(_, rating)| rating.score);
    let n_competing = fitting
        .iter()
        .filter(|(_, r)| r.score >= COMPETING_SHARE * best)
        .count();
    let wants_one = phrase.wants_one();
    let (n_chosen, doubt) = number_chosen(phrase, n_fitting, n_competing);
    fitting.truncate(n_chosen);
    let tracks: Vec<_> = fitting
        .iter()
        .map(|(i, _)| world.objects[*i].track_id)
        .collect();
    let doubt = doubt.map(|doubt| format!("{doubt}: {}", answer_text::tracks(&tracks)));
    let to_match = |(index, rating): (usize, Rating)| {
        to_match(
            &world.objects[index],
            rating,
            doubt.as_deref(),
            world.now_ns,
        )
    };
    Selection {
        text,
        matches: fitting.into_iter().map(to_match).collect(),
        wants_one,
        n_fitting,
        reason: None,
        advice: None,
    }
}

/// Number of objects that a phrase takes of those that fit, and a doubt if it expects another.
fn number_chosen(
    phrase: &NounPhrase,
    n_fitting: usize,
    n_competing: usize,
) -> (usize, Option<String>) {
    if phrase.wants_one() {
        return match phrase.quantity {
            Quantity::Any | Quantity::Exactly(_) => (1, None),
            _ if n_competing > 1 => (n_competing, Some(format!("{n_competing} objects fit"))),
            _ => (1, None),
        };
    }
    match phrase.quantity {
        Quantity::All(Some(n)) if n != n_fitting => (
            n_fitting,
            Some(format!("{n} objects are expected, and {n_fitting} fit")),
        ),
        Quantity::Exactly(n) if n > n_fitting => (
            n_fitting,
            Some(format!("only {n_fitting} of {n} objects fit")),
        ),
        Quantity::Exactly(n) if n < n_fitting => (
            n,
            Some(format!("{n_fitting} objects fit, of which {n} were taken")),
        ),
        _ => (n_fitting, None),
    }
}

fn to_match(object: &WorldObject, rating: Rating, doubt: Option<&str>, now_ns: i64) -> Match {
    let mut doubts = rating.doubts;
    doubts.extend(doubt.map(str::to_owned));
    let track_id = object.track_id;
    let age = duration_text(now_ns.saturating_sub(object.last_seen_ns));
    match object.presence {
        Presence::InView => {}
        Presence::OutOfView => doubts.push(format!(
            "track {track_id} is not in view; it was last seen {age} ago"
        )),
        Presence::Gone => doubts.push(format!(
            "track {track_id} is gone; its place is as last seen, {age} ago"
        )),
    }
    if doubts.is_empty() && rating.score < CLEAR_SCORE {
        doubts.push(format!(
            "track {track_id} fits only by {:.0} %",
            100.0 * rating.score
        ));
    }
    Match {
        track_id,
        score: rating.score,
        doubts,
    }
}

fn with_doubts(mut selection: Selection, general: &[String]) -> Selection {
    for found in &mut selection.matches {
        let new = general.iter().filter(|doubt| !found.doubts.contains(doubt));
        let new: Vec<String> = new.cloned().collect();
        found.doubts.extend(new);
    }
    selection
}

/// Matches of all phrases; an object of several phrases counts once.
fn merged(selections: Vec<Selection>) -> Vec<Match> {
    let mut matches: Vec<Match> = Vec::new();
    for found in selections
        .into_iter()
        .flat_map(|selection| selection.matches)
    {
        if !matches.iter().any(|other| other.track_id == found.track_id) {
            matches.push(found);
        }
    }
    matches
}
