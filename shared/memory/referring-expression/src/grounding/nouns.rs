//! Nouns: the categories that spoken words may name, and the objects of these categories.

use std::collections::HashMap;

use super::{Grounder, Judgement, Rating};
use crate::compound::{NameAgreement, agreement, is_container};
use crate::expression::{Noun, NounPhrase};
use crate::lexicon::{Kinship, are_everyday_synonyms};
use crate::names::{name_key, singular};
use crate::tokens::{SpokenWord, WordSpan};
use crate::vocabulary;
use crate::world::WorldObject;

/// Score of an object for a noun that is not understood.
const UNKNOWN_NOUN_SCORE: f64 = 0.5;

/// Score of a category that the words name or contain, rather than resemble.
const NEAR_SCORE: f64 = 0.6;

/// Score of a category whose name ends with the words. Chosen.
const HEAD_SCORE: f64 = 0.75;

/// Score of a category whose container has the words as its contents: it competes with those
/// whose name ends with the words, but not with those of the very name. Chosen.
const CONTENTS_SCORE: f64 = 0.72;

/// Score of a category of whose name the words are another part. Chosen.
const PART_SCORE: f64 = 0.6;

/// Probability of a name from which on it is not doubtful.
const SURE_PROBABILITY: f64 = 0.9;

/// Meaning of an English noun without a category.
pub(crate) const UNRELATED_NOUN: &str = "a noun; no name that was taught is related";

/// Fit of a category to a noun.
#[derive(Debug, Clone, PartialEq)]
struct CategoryFit {
    score: f64,
    /// Doubt of the fit, as a sentence.
    doubt: Option<String>,
}

impl Grounder<'_> {
    /// Ratings of all objects by the noun of a phrase; 0 for those out of the scope.
    pub(super) fn rate_noun(&mut self, phrase: &NounPhrase) -> Vec<Rating> {
        let mut ratings = self.rate_by_noun(phrase);
        for (rating, object) in ratings.iter_mut().zip(self.world.objects) {
            if !self.scope.contains(object) {
                rating.score = 0.0;
            }
        }
        ratings
    }

    fn rate_by_noun(&mut self, phrase: &NounPhrase) -> Vec<Rating> {
        let mut ratings = vec![Rating::default(); self.world.objects.len()];
        let Noun::Category(span) = phrase.noun else {
            return ratings;
        };
        let fits = self.resolve(span);
        let word = self.text(span);
        if self.notes.ignored.contains(&span) {
            for rating in &mut ratings {
                rating.score = UNKNOWN_NOUN_SCORE;
            }
            return ratings;
        }
        for (rating, object) in ratings.iter_mut().zip(self.world.objects) {
            rating.apply(judge_noun(object, &fits, &word));
            rating.has_category = rating.lacks_nothing();
        }
        ratings
    }

    /// True if the noun of a phrase was not understood.
    pub(crate) fn is_noun_ignored(&self, phrase: &NounPhrase) -> bool {
        matches!(phrase.noun, Noun::Category(span) if self.notes.ignored.contains(&span))
    }

    /// Categories that the words may name. Words that name none are noted as not understood.
    fn resolve(&mut self, span: WordSpan) -> HashMap<String, CategoryFit> {
        // "Shiny gadget": the whole compound, then its head.
        for start in span.start..span.end {
            let part = WordSpan { start, ..span };
            let spoken = part.of(self.words);
            let is_part = |name: &Vec<SpokenWord>| agreement(spoken, name).is_some();
            let is_adjective = spoken.len() > 1
                && vocabulary::is_ordinary(&self.words[start].word)
                && !self.known_names.values().any(is_part);
            if is_adjective {
                continue;
            }
            let fits = self.fits(part);
            if !fits.is_empty() {
                self.note_noun(span, part, &fits);
                return fits;
            }
            if start == span.start
                && let Some(fits) = self.resolve_contained(span)
            {
                return fits;
            }
        }
        self.notes.wants_synonyms = true;
        let noun = (span.start..span.end)
            .map(|start| WordSpan { start, ..span })
            .find(|part| self.is_noun(*part));
        if let Some(noun) = noun {
            self.ignore_before(span, noun);
            let meaning = UNRELATED_NOUN.to_owned();
            self.note_meaning(noun, meaning);
        } else if !self.notes.ignored.contains(&span) {
            self.notes.ignored.push(span);
        }
        HashMap::new()
    }

    fn is_noun(&self, span: WordSpan) -> bool {
        let words = normalised(span.of(self.words));
        self.lexicon.is_some_and(|lexicon| lexicon.is_noun(&words))
    }

    /// Notes that the words of a compound before its head are not understood.
    fn ignore_before(&mut self, span: WordSpan, head: WordSpan) {
        let before = WordSpan {
            start: span.start,
            end: head.start,
        };
        if !before.is_empty() && !self.notes.ignored.contains(&before) {
            self.notes.ignored.push(before);
        }
    }

    /// Categories of "juice carton": orange juice, the words before the container being its name
    /// or the last words of its name.
    fn resolve_contained(&mut self, span: WordSpan) -> Option<HashMap<String, CategoryFit>> {
        let contents = WordSpan {
            end: span.end - 1,
            ..span
        };
        let container = span.of(self.words).last()?;
        if contents.is_empty() || !is_container(&container.word) {
            return None;
        }
        let spoken = contents.of(self.words);
        let names = self.known_names.iter();
        let fits = names.filter_map(|(name, words)| {
            let is_itself = matches!(
                agreement(spoken, words)?,
                NameAgreement::Same | NameAgreement::Head
            );
            let doubt = format!("`{}` was taken as {name}", normalised(span.of(self.words)));
            is_itself.then(|| ((*name).to_owned(), doubtful(HEAD_SCORE, doubt)))
        });
        let fits: HashMap<String, CategoryFit> = fits.collect();
        if fits.is_empty() {
            return None;
        }
        self.note_noun(span, span, &fits);
        Some(fits)
    }

    fn note_noun(&mut self, span: WordSpan, part: WordSpan, fits: &HashMap<String, CategoryFit>) {
        self.ignore_before(span, part);
        let mut names: Vec<_> = fits.iter().collect();
        names.sort_by(|a, b| b.1.score.total_cmp(&a.1.score).then(a.0.cmp(b.0)));
        let is_direct = names.first().is_some_and(|(_, fit)| fit.doubt.is_none());
        self.notes.wants_synonyms |= !is_direct;
        let is_here = |name: &str| {
            let mut best = self.world.objects.iter().filter_map(WorldObject::best_name);
            best.any(|best| best == name)
        };
        // The categories that can be found come first.
        names.sort_by_key(|(name, _)| !is_here(name));
        if let Some(n_here) = names.iter().position(|(name, _)| !is_here(name))
            && n_here > 0
        {
            names.truncate(n_here);
        }
        let names: Vec<_> = names
            .iter()
            .take(4)
            .map(|(name, _)| name.as_str())
            .collect();
        self.note_meaning(part, format!("the category {}", names.join(" or ")));
    }

    fn note_meaning(&mut self, span: WordSpan, meaning: String) {
        if !self.notes.nouns.iter().any(|(noted, _)| *noted == span) {
            self.notes.nouns.push((span, meaning));
        }
    }

    /// Categories that fit the words, of the closest kinship only: who says "vase" where vases
    /// were taught means no jar.
    fn fits(&self, span: WordSpan) -> HashMap<String, CategoryFit> {
        let spoken = span.of(self.words);
        let fits_by = |fit: &dyn Fn(&str, &[SpokenWord]) -> Option<CategoryFit>| {
            let names = self.known_names.iter();
            let fits =
                names.filter_map(|(name, words)| Some(((*name).to_owned(), fit(name, words)?)));
            fits.collect::<HashMap<_, _>>()
        };
        let is_exact = self.is_name_of_object(spoken);
        let named = fits_by(&|name, words| {
            let agreement = agreement(spoken, words)?;
            let is_excluded = is_exact && agreement == NameAgreement::Contents;
            (!is_excluded).then(|| fit_of_name(agreement, spoken, name))?
        });
        if !named.is_empty() {
            return named;
        }
        let related = fits_by(&|name, words| self.fit_of_meaning(spoken, name, words));
        let closest = related.values().map(|fit| fit.score).fold(0.0, f64::max);
        if closest < NEAR_SCORE {
            let parts =
                fits_by(&|name, words| fit_of_part(agreement(spoken, words)?, spoken, name));
            if !parts.is_empty() {
                return parts;
            }
        }
        let is_near = |fit: &CategoryFit| closest < NEAR_SCORE || fit.score >= NEAR_SCORE;
        related
            .into_iter()
            .filter(|(_, fit)| is_near(fit))
            .collect()
    }

    /// True if an object has exactly the spoken name.
    fn is_name_of_object(&self, spoken: &[SpokenWord]) -> bool {
        let key = name_key(spoken);
        let names = self.world.objects.iter().filter_map(WorldObject::best_name);
        let words = names.filter_map(|name| self.known_names.get(name));
        words.into_iter().any(|words| name_key(words) == key)
    }

    /// Fit of a category whose name means the same as the words, or something related.
    fn fit_of_meaning(
        &self,
        spoken: &[SpokenWord],
        name: &str,
        name_words: &[SpokenWord],
    ) -> Option<CategoryFit> {
        let words = normalised(spoken);
        if are_everyday_synonyms(&singular_form(spoken), &singular_form(name_words)) {
            let doubt = format!("`{words}` was taken as a synonym of {name}");
            return Some(doubtful(0.7, doubt));
        }
        let fit = match self.lexicon?.kinship(&words, name)? {
            Kinship::Synonym => {
                doubtful(0.7, format!("`{words}` was taken as a synonym of {name}"))
            }
            Kinship::Broader { n_levels } => doubtful(
                0.78 - 0.03 * f64::from(n_levels),
                format!("`{words}` was taken as a kind to which {name} belongs"),
            ),
            Kinship::Narrower { .. } => doubtful(
                0.5,
                format!("`{words}` is a kind of {name}; the kind is not known"),
            ),
            Kinship::Sister => doubtful(0.35, format!("`{words}` is only related to {name}")),
        };
        Some(fit)
    }
}

fn doubtful(score: f64, doubt: String) -> CategoryFit {
    CategoryFit {
        score,
        doubt: Some(doubt),
    }
}

/// Fit of a category by its name: all of it, the last words of a compound, or its contents.
fn fit_of_name(agreement: NameAgreement, spoken: &[SpokenWord], name: &str) -> Option<CategoryFit> {
    let score = match agreement {
        NameAgreement::Same => {
            return Some(CategoryFit {
                score: 1.0,
                doubt: None,
            });
        }
        NameAgreement::Head => HEAD_SCORE,
        NameAgreement::Contents => CONTENTS_SCORE,
        NameAgreement::Part => return None,
    };
    let words = normalised(spoken);
    Some(doubtful(score, format!("`{words}` was taken as {name}")))
}

/// Fit of a category by any other part of its name.
fn fit_of_part(agreement: NameAgreement, spoken: &[SpokenWord], name: &str) -> Option<CategoryFit> {
    let words = normalised(spoken);
    let doubt = format!("`{words}` was taken as {name}");
    (agreement == NameAgreement::Part).then(|| doubtful(PART_SCORE, doubt))
}

fn normalised(words: &[SpokenWord]) -> String {
    let words: Vec<_> = words.iter().map(|word| word.word.as_str()).collect();
    words.join(" ")
}

fn singular_form(words: &[SpokenWord]) -> String {
    let mut words: Vec<String> = words.iter().map(|word| word.word.clone()).collect();
    if let Some(last) = words.last_mut() {
        *last = singular(last);
    }
    words.join(" ")
}

/// Judgement of an object by its names: the one that fits best.
fn judge_noun(object: &WorldObject, fits: &HashMap<String, CategoryFit>, word: &str) -> Judgement {
    let track = object.track_id;
    // What a person said of this very object excludes the other names.
    let n_names = if object.is_labelled {
        1
    } else {
        object.names.len()
    };
    let scored = object
        .names
        .iter()
        .take(n_names)
        .filter_map(|(name, probability)| {
            let fit = fits.get(name)?;
            let is_sure = object.is_labelled || !probability.is_finite();
            let probability = if is_sure {
                1.0
            } else {
                probability.clamp(0.0, 1.0)
            };
            Some((name, probability, fit))
        });
    let best = scored.max_by(|a, b| (a.1 * a.2.score).total_cmp(&(b.1 * b.2.score)));
    let label = object.best_name().unwrap_or("unknown object");
    let Some((name, probability, fit)) = best else {
        let label = with_article(label);
        return Judgement::new(0.0, "", format!("is {label}, not `{word}`"));
    };
    let mut judgement = Judgement::new(
        probability * fit.score,
        format!("is {}", with_article(name)),
        format!(
            "is rather {} than {}",
            with_article(label),
            with_article(name)
        ),
    )
    .doubt_if(probability < SURE_PROBABILITY, || {
        format!(
            "the label {name} of track {track} is only {:.0} % sure",
            100.0 * probability
        )
    })
    .doubt_if(name != label, || {
        let [label, name] = [label, name].map(with_article);
        format!("track {track} is rather {label} than {name}")
    });
    judgement.doubts.extend(fit.doubt.clone());
    judgement
}

/// Name with "a" or "an".
fn with_article(name: &str) -> String {
    let is_vowel = name.starts_with(['a', 'e', 'i', 'o', 'u']);
    format!("{} {name}", if is_vowel { "an" } else { "a" })
}
