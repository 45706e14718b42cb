//! Referring expression comprehension: from a query to an answer.

use crate::answer::{Answer, Match, WordUse};
use crate::answer_text;
use crate::error::Error;
use crate::expression::{NounPhrase, Quantity};
use crate::grounding::{COMPETING_SHARE, Grounder, MATCH_MIN, Notes, Rating};
use crate::lexicon::Lexicon;
use crate::names::NameIndex;
use crate::parser::{Parse, parse};
use crate::time_phrase::duration_text;
use crate::tokens::{SpokenWord, tokenize};
use crate::world::{QueryWorld, WorldObject};

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
    /// Sentence about the closest object if none fits.
    pub(crate) closest: Option<String>,
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
    let parse = parse(&words, &name_index(world));
    let mut grounder = Grounder::new(&words, world, lexicon);
    let phrases = &parse.expression.phrases;
    let rated: Vec<(&NounPhrase, Vec<Rating>, bool)> = phrases
        .iter()
        .map(|phrase| {
            let ratings = grounder.rate_outermost(phrase);
            (phrase, ratings, grounder.is_noun_ignored(phrase))
        })
        .collect();
    let notes = grounder.into_notes();
    let (understood, not_understood) = account(&words, &parse, &notes);
    let general = general_doubts(&parse, &notes, &not_understood);
    let selections: Vec<Selection> = rated
        .into_iter()
        .map(|(phrase, ratings, is_noun_ignored)| {
            let has_content = !phrase.restrictions.is_empty() || !phrase.rankings.is_empty();
            let is_empty = is_noun_ignored && !has_content || understood.is_empty();
            let ratings = if is_empty { Vec::new() } else { ratings };
            select(phrase, ratings, world, phrase.span.text(&words))
        })
        .map(|selection| with_doubts(selection, &general))
        .collect();
    let remarks = remarks(&parse, lexicon.is_none());
    let sentence = answer_text::sentence(&selections, &general, parse.expression.is_alternative);
    let sentence = if lexicon.is_none() && notes.wants_synonyms {
        format!("{sentence} Note: {SYNONYMS_OFF}.")
    } else {
        sentence
    };
    let wants_one = match selections.as_slice() {
        [one] => one.wants_one,
        _ => parse.expression.is_alternative,
    };
    Ok(Answer {
        matches: merged(selections),
        wants_one,
        understood,
        not_understood,
        remarks,
        sentence,
    })
}

fn name_index(world: &QueryWorld<'_>) -> NameIndex {
    let of_objects = world.objects.iter().flat_map(|object| &object.names);
    let names = of_objects.map(|(name, _)| name).chain(world.taught_names);
    NameIndex::new(names.map(String::as_str))
}

/// Uses of all words, and the words without one. Each word is in exactly one of the two.
fn account(words: &[SpokenWord], parse: &Parse, notes: &Notes) -> (Vec<WordUse>, Vec<String>) {
    let is_ignored = |position| notes.ignored.iter().any(|span| span.contains(position));
    let mut meanings: Vec<Option<(usize, &str)>> = vec![None; words.len()];
    for (number, (span, meaning)) in parse.uses.iter().chain(&notes.nouns).enumerate() {
        let covered = meanings.get_mut(span.start..span.end).unwrap_or_default();
        for word in covered {
            word.get_or_insert((number, meaning));
        }
    }
    let mut uses: Vec<WordUse> = Vec::new();
    let mut not_understood = Vec::new();
    let mut previous = None;
    for (position, word) in words.iter().enumerate() {
        let meaning = meanings[position].filter(|_| !is_ignored(position));
        match (meaning, uses.last_mut()) {
            (None, _) => not_understood.push(word.text.clone()),
            (Some((number, _)), Some(last)) if previous == Some(number) => {
                last.words.push(' ');
                last.words.push_str(&word.text);
            }
            (Some((_, meaning)), _) => uses.push(WordUse {
                words: word.text.clone(),
                meaning: meaning.to_owned(),
            }),
        }
        previous = meaning.map(|(number, _)| number);
    }
    (uses, not_understood)
}

/// Doubts that concern every match.
fn general_doubts(parse: &Parse, notes: &Notes, not_understood: &[String]) -> Vec<String> {
    let mut doubts = notes.doubts.clone();
    doubts.extend(parse.remarks.iter().cloned());
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

fn remarks(parse: &Parse, is_without_lexicon: bool) -> Vec<String> {
    let mut remarks = parse.remarks.clone();
    if is_without_lexicon {
        remarks.push(SYNONYMS_OFF.to_owned());
    }
    remarks
}

/// Chooses the objects of a phrase by its number.
fn select(
    phrase: &NounPhrase,
    ratings: Vec<Rating>,
    world: &QueryWorld<'_>,
    text: String,
) -> Selection {
    let closest = closest(&ratings, world);
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
        closest,
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
    if !object.is_in_view {
        let age = duration_text(now_ns.saturating_sub(object.last_seen_ns));
        doubts.push(format!(
            "track {track_id} is not in view; it was last seen {age} ago"
        ));
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

/// Sentence about the object that lacks least.
fn closest(ratings: &[Rating], world: &QueryWorld<'_>) -> Option<String> {
    let candidates = ratings.iter().zip(world.objects);
    let with_fit =
        candidates.filter(|(rating, _)| !rating.fits.is_empty() && !rating.lacks.is_empty());
    let (rating, object) = with_fit.max_by_key(|(rating, _)| {
        let n_lacks = std::cmp::Reverse(rating.lacks.len());
        (rating.has_category, n_lacks, rating.fits.len())
    })?;
    let (fits, lacks) = (rating.fits.join(" and "), rating.lacks.join(" and "));
    Some(format!("track {} {fits}, but {lacks}", object.track_id))
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
