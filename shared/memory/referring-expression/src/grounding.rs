//! Grounding: from a syntax tree to graded objects of a world.
//!
//! Each predicate gives a score from 0 to 1, and the scores of a phrase are multiplied, as
//! probabilities of independent observations are. Landmarks are grounded first, by the same rules.

mod colors;
mod judgement;
mod lessons;
mod nouns;
mod rankings;
mod relations;
mod sides;
mod sizes;

use std::collections::{BTreeMap, BTreeSet};

use crate::box_geometry::BoxGeometry;
use crate::expression::{Noun, NounPhrase, Restriction, RestrictionKind};
use crate::lexicon::Lexicon;
use crate::relation::ViewFrame;
use crate::tokens::{SpokenWord, WordSpan, tokenize};
use crate::world::{Presence, QueryWorld, WorldObject};
pub(crate) use judgement::{Judgement, Rating};
pub(crate) use nouns::UNRELATED_NOUN;

/// Least score of an object that fits. Chosen.
pub(crate) const MATCH_MIN: f64 = 0.3;

/// Share of the best score from which on another object competes with the best. Chosen.
pub(crate) const COMPETING_SHARE: f64 = 0.8;

/// Most landmarks of a phrase that are considered, best first.
const LANDMARKS_MAX: usize = 16;

/// World prepared for one query, and the notes about it.
pub(crate) struct Grounder<'a> {
    words: &'a [SpokenWord],
    world: &'a QueryWorld<'a>,
    lexicon: Option<&'a dyn Lexicon>,
    view: Option<ViewFrame>,
    geometries: Vec<BoxGeometry>,
    /// Objects that the outermost phrase is about.
    scope: Scope,
    /// Names of all categories with their words.
    known_names: BTreeMap<&'a str, Vec<SpokenWord>>,
    notes: Notes,
}

/// Objects that a phrase may refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scope {
    /// Objects that are there.
    Present,
    /// Objects that are gone.
    Gone,
}

impl Scope {
    pub(crate) fn contains(self, object: &WorldObject) -> bool {
        object.is_gone() == (self == Self::Gone)
    }
}

/// Objects of an outermost phrase with their ratings.
#[derive(Debug)]
pub(crate) struct Grounding {
    pub(crate) scope: Scope,
    pub(crate) ratings: Vec<Rating>,
    /// Tracks that are gone and may fit, if nothing fits.
    pub(crate) maybe_gone: Vec<u64>,
}

impl Grounding {
    fn new(scope: Scope, ratings: Vec<Rating>) -> Self {
        Self {
            scope,
            ratings,
            maybe_gone: Vec::new(),
        }
    }
}

/// Order of the restrictions: those that compare the candidates come last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RestrictionStage {
    Property,
    Place,
    RelativeSize,
}

impl RestrictionStage {
    const ALL: [Self; 3] = [Self::Property, Self::Place, Self::RelativeSize];

    fn of(kind: &RestrictionKind) -> Self {
        match kind {
            RestrictionKind::Place(_) => Self::Place,
            RestrictionKind::Size(..) => Self::RelativeSize,
            _ => Self::Property,
        }
    }
}

/// Notes about the words of a query.
#[derive(Debug, Default)]
pub(crate) struct Notes {
    /// Doubts that concern every answer.
    pub(crate) doubts: Vec<String>,
    /// Words that turned out not to be understood.
    pub(crate) ignored: Vec<WordSpan>,
    /// Meanings of nouns.
    pub(crate) nouns: Vec<(WordSpan, String)>,
    /// True if a noun found no name by itself, so that synonyms would help.
    pub(crate) wants_synonyms: bool,
}

/// Object that may be a landmark.
#[derive(Debug, Clone)]
pub(crate) struct Landmark {
    index: usize,
    /// Score relative to that of the best landmark.
    weight: f64,
    doubts: Vec<String>,
}

impl<'a> Grounder<'a> {
    pub(crate) fn new(
        words: &'a [SpokenWord],
        world: &'a QueryWorld<'a>,
        lexicon: Option<&'a dyn Lexicon>,
    ) -> Self {
        Self {
            words,
            world,
            lexicon,
            view: world.viewpoint.as_ref().and_then(ViewFrame::new),
            geometries: world.objects.iter().map(BoxGeometry::new).collect(),
            scope: Scope::Present,
            known_names: known_names(world),
            notes: Notes::default(),
        }
    }

    pub(crate) fn into_notes(self) -> Notes {
        self.notes
    }

    /// Ratings of the objects of an outermost phrase: those that are there, and if none of them
    /// fits, those that are gone.
    pub(crate) fn rate_outermost(&mut self, phrase: &NounPhrase) -> Grounding {
        if phrase.wants_gone() {
            let of_gone = self.rate_gone(phrase);
            return Grounding::new(Scope::Gone, of_gone);
        }
        let n_doubts = self.notes.doubts.len();
        let ratings = self.rate_attached(phrase);
        let has_gone = self.world.objects.iter().any(WorldObject::is_gone);
        let is_vague = phrase.noun == Noun::Anything && !phrase.has_lasting_property();
        if has_match(&ratings) || !has_gone || is_vague {
            return Grounding::new(Scope::Present, ratings);
        }
        let doubts = self.notes.doubts.split_off(n_doubts);
        let of_gone = self.rate_gone(phrase);
        if has_match(&of_gone) {
            return Grounding::new(Scope::Gone, of_gone);
        }
        self.notes.doubts.truncate(n_doubts);
        self.notes.doubts.extend(doubts);
        let maybe_gone = self.tracks_where(&of_gone, Scope::Gone, Rating::may_fit);
        let has_category = |rating: &Rating| rating.has_category;
        let is_here = !self
            .tracks_where(&ratings, Scope::Present, has_category)
            .is_empty();
        let is_only_gone = !is_here && maybe_gone.is_empty();
        Grounding {
            maybe_gone,
            ..if is_only_gone {
                Grounding::new(Scope::Gone, of_gone)
            } else {
                Grounding::new(Scope::Present, ratings)
            }
        }
    }

    fn rate_gone(&mut self, phrase: &NounPhrase) -> Vec<Rating> {
        self.scope = Scope::Gone;
        let of_gone = self.rate_attached(phrase);
        self.scope = Scope::Present;
        of_gone
    }

    /// Tracks of a scope whose rating passes a test.
    fn tracks_where(
        &self,
        ratings: &[Rating],
        scope: Scope,
        test: impl Fn(&Rating) -> bool,
    ) -> Vec<u64> {
        let pairs = self.world.objects.iter().zip(ratings);
        pairs
            .filter(|(object, rating)| scope.contains(object) && test(rating))
            .map(|(object, _)| object.track_id)
            .collect()
    }

    /// Ratings of all objects, with the other attachment of a landmark if the nearest finds none.
    fn rate_attached(&mut self, phrase: &NounPhrase) -> Vec<Rating> {
        let ratings = self.rate(phrase);
        if has_match(&ratings) {
            return ratings;
        }
        let mut attached = phrase.reattached();
        for _ in 0..3 {
            let Some(other) = attached else {
                break;
            };
            let others = self.rate(&other);
            if has_match(&others) {
                return others;
            }
            attached = other.reattached();
        }
        ratings
    }

    /// Ratings of all objects: properties, places, relative sizes, then ranks.
    pub(crate) fn rate(&mut self, phrase: &NounPhrase) -> Vec<Rating> {
        let mut ratings = self.rate_noun(phrase);
        let mut before_place = None;
        for stage in RestrictionStage::ALL {
            if stage == RestrictionStage::Place {
                before_place = Some(ratings.clone());
            }
            for restriction in &phrase.restrictions {
                if RestrictionStage::of(&restriction.kind) == stage {
                    self.apply(restriction, &mut ratings);
                }
            }
        }
        if let Some(before) = before_place {
            self.prefer_furthest(phrase, &before, &mut ratings);
        }
        for ranking in &phrase.rankings {
            self.apply_ranking(ranking, &mut ratings);
        }
        ratings
    }

    fn apply(&mut self, restriction: &Restriction, ratings: &mut [Rating]) {
        let Some(judgements) = self.judge(restriction, ratings) else {
            return;
        };
        for ((rating, judgement), object) in
            ratings.iter_mut().zip(judgements).zip(self.world.objects)
        {
            let is_unknown = is_unknown(object, &restriction.kind);
            rating.n_unknown += usize::from(is_unknown);
            rating.apply(if is_unknown {
                Judgement::new(0.0, "", "is gone, and that is not known of it")
            } else if restriction.is_negated {
                judgement.negated()
            } else {
                judgement
            });
        }
    }

    /// Judgements of all objects; None if the restriction cannot be judged, which is noted.
    fn judge(&mut self, restriction: &Restriction, ratings: &[Rating]) -> Option<Vec<Judgement>> {
        let span = restriction.span;
        let world = self.world;
        let objects = world.objects.iter();
        Some(match &restriction.kind {
            RestrictionKind::Color(color) => self.judge_color(color, restriction, ratings),
            RestrictionKind::Size(dimension, degree) => {
                self.judge_size(*dimension, *degree, ratings)
            }
            RestrictionKind::SizeThan(dimension, degree, other) => {
                self.judge_size_than((*dimension, *degree), other, span)?
            }
            RestrictionKind::Measure(dimension, bound, measure_m) => {
                self.judge_measure(*dimension, *bound, *measure_m)
            }
            RestrictionKind::Relation(relation, landmark) => {
                self.judge_relation(*relation, landmark, span)?
            }
            RestrictionKind::Between(landmarks) => self.judge_between(landmarks, span)?,
            RestrictionKind::Place(place) | RestrictionKind::Region(place) => {
                self.judge_place(*place, span)?
            }
            RestrictionKind::Labelled => objects
                .map(|o| Judgement::of_fact(o.is_labelled, "is labelled", "is not labelled"))
                .collect(),
            RestrictionKind::InView => objects
                .map(|o| o.presence == Presence::InView)
                .map(|is_in_view| Judgement::of_fact(is_in_view, "is in view", "is not in view"))
                .collect(),
            RestrictionKind::Gone => objects
                .map(|o| Judgement::of_fact(o.is_gone(), "is gone", "is not gone"))
                .collect(),
            RestrictionKind::Taught(author, time) => self.judge_taught(*author, *time, span),
            RestrictionKind::Seen(time) => self.judge_seen(*time, span),
            RestrictionKind::Appeared(time) => self.judge_appeared(*time, span),
            RestrictionKind::Is(phrase) => self.judge_identity(phrase, span)?,
        })
    }

    /// Landmarks of a phrase, best first: objects that are there, and if none of them fits, objects
    /// that are gone. None if its words are not understood.
    fn landmarks(&mut self, phrase: &NounPhrase) -> Option<Vec<Landmark>> {
        let outer = self.scope;
        self.scope = Scope::Present;
        let mut ratings = self.rate(phrase);
        if !has_match(&ratings) && self.world.objects.iter().any(WorldObject::is_gone) {
            self.scope = Scope::Gone;
            ratings = self.rate(phrase);
            for (rating, object) in ratings.iter_mut().zip(self.world.objects) {
                let track = object.track_id;
                rating
                    .doubts
                    .push(format!("track {track} is gone; its place is as last seen"));
            }
        }
        self.scope = outer;
        let is_not_understood = phrase.is_vague || self.is_noun_ignored(phrase);
        if is_not_understood && phrase.restrictions.is_empty() && phrase.rankings.is_empty() {
            return None;
        }
        let best = ratings.iter().map(|r| r.score).fold(0.0, f64::max);
        let mut landmarks: Vec<Landmark> = ratings
            .into_iter()
            .enumerate()
            .filter(|(_, rating)| rating.score >= MATCH_MIN)
            .map(|(index, rating)| Landmark {
                index,
                weight: rating.score / best,
                doubts: rating.doubts,
            })
            .collect();
        landmarks.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        landmarks.truncate(LANDMARKS_MAX);
        Some(landmarks)
    }

    /// Notes that words are not used, with the reason.
    fn ignore(&mut self, span: WordSpan, reason: &str) {
        if !self.notes.ignored.contains(&span) {
            self.notes.ignored.push(span);
        }
        let words = span.text(self.words);
        self.doubt(format!("`{words}` was not used: {reason}"));
    }

    fn doubt(&mut self, doubt: String) {
        if !self.notes.doubts.contains(&doubt) {
            self.notes.doubts.push(doubt);
        }
    }

    fn track(&self, index: usize) -> u64 {
        self.world.objects[index].track_id
    }

    fn text(&self, span: WordSpan) -> String {
        span.text(self.words)
    }
}

fn has_match(ratings: &[Rating]) -> bool {
    ratings.iter().any(|rating| rating.score >= MATCH_MIN)
}

/// True if a restriction asks for what is not known of an object that is gone.
fn is_unknown(object: &WorldObject, kind: &RestrictionKind) -> bool {
    object.is_gone()
        && match kind {
            RestrictionKind::Color(_) => !colors::has_known_color(object),
            RestrictionKind::Is(_) => object.names.is_empty(),
            _ => false,
        }
}

fn known_names<'a>(world: &QueryWorld<'a>) -> BTreeMap<&'a str, Vec<SpokenWord>> {
    let of_objects = world.objects.iter().flat_map(|object| &object.names);
    let names = of_objects.map(|(name, _)| name).chain(world.taught_names);
    let distinct: BTreeSet<&str> = names.map(String::as_str).collect();
    distinct
        .into_iter()
        .map(|name| (name, tokenize(name)))
        .collect()
}
