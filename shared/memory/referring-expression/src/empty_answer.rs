//! Reason of an empty answer: a noun without objects, or what the nearest object lacks.

use crate::answer_text::tracks;
use crate::expression::{Noun, NounPhrase, Restriction, RestrictionKind};
use crate::grounding::{Grounding, Notes, Rating, UNRELATED_NOUN};
use crate::tokens::SpokenWord;
use crate::world::{QueryWorld, WorldObject};

/// Least nearness of an object that is named without a noun or a predicate that fits. Chosen.
const NEARNESS_MIN: f64 = 0.05;

/// Reason why nothing fits a phrase, as sentences.
pub(crate) fn reason(
    phrase: &NounPhrase,
    grounding: &Grounding,
    notes: &Notes,
    world: &QueryWorld<'_>,
    words: &[SpokenWord],
) -> Option<String> {
    let nearest =
        missing_noun(phrase, grounding, notes, words).or_else(|| nearest(phrase, grounding, world));
    let is_color = |one: &Restriction| matches!(one.kind, RestrictionKind::Color(_));
    let unknown = if phrase.restrictions.iter().any(is_color) {
        "colour"
    } else {
        "name"
    };
    let gone = match grounding.maybe_gone.as_slice() {
        [] => None,
        [one] => Some(format!(
            "track {one}, which is gone, may fit: its {unknown} is not known"
        )),
        several => Some(format!(
            "{}, which are gone, may fit: their {unknown} is not known",
            tracks(several)
        )),
    };
    let reasons: Vec<String> = nearest.into_iter().chain(gone).collect();
    (!reasons.is_empty()).then(|| reasons.join("; "))
}

/// Sentence about a noun that no object has.
fn missing_noun(
    phrase: &NounPhrase,
    grounding: &Grounding,
    notes: &Notes,
    words: &[SpokenWord],
) -> Option<String> {
    let Noun::Category(span) = phrase.noun else {
        return None;
    };
    if grounding.ratings.iter().any(|rating| rating.has_category) {
        return None;
    }
    let text = span.text(words);
    let is_unrelated = |(noun, meaning): &(crate::tokens::WordSpan, String)| {
        meaning == UNRELATED_NOUN && span.contains(noun.start)
    };
    Some(if notes.nouns.iter().any(is_unrelated) {
        format!("no name that was taught is related to `{text}`")
    } else {
        format!("no object here is named `{text}`")
    })
}

/// Sentence about the object that lacks least.
fn nearest(phrase: &NounPhrase, grounding: &Grounding, world: &QueryWorld<'_>) -> Option<String> {
    let all = grounding.ratings.iter().zip(world.objects);
    let has_noun = phrase.noun != Noun::Anything;
    let is_near =
        |rating: &Rating| !rating.fits.is_empty() || !has_noun && rating.nearness >= NEARNESS_MIN;
    let candidates =
        all.filter(|(rating, object)| grounding.scope.contains(object) && is_near(rating));
    let (rating, object) = candidates.max_by(|(a, _), (b, _)| {
        let key = |rating: &Rating| {
            let n_lacks = std::cmp::Reverse(rating.lacks.len());
            (rating.has_category, n_lacks, rating.fits.len())
        };
        let by_key = key(a).cmp(&key(b));
        by_key.then(a.nearness.total_cmp(&b.nearness))
    })?;
    Some(nearest_text(rating, object))
}

fn nearest_text(rating: &Rating, object: &WorldObject) -> String {
    let track = object.track_id;
    let is_gone = if object.is_gone() { "is gone and " } else { "" };
    let (fits, lacks) = (rating.fits.join(" and "), rating.lacks.join(" and "));
    match (fits.as_str(), lacks.as_str()) {
        ("", "") => format!("track {track} {is_gone}comes nearest"),
        ("", lacks) => format!("track {track} {is_gone}comes nearest, but {lacks}"),
        (fits, "") => {
            let doubts = rating.doubts.join("; ");
            format!("track {track} {is_gone}{fits}, but hardly: {doubts}")
        }
        (fits, lacks) => format!("track {track} {is_gone}{fits}, but {lacks}"),
    }
}
