//! Referring expression as a syntax tree: noun phrases, their restrictions and rankings.

use crate::relation::{Relation, TablePlace};
use crate::shade::Shade;
use crate::size::{Bound, Degree, Dimension};
use crate::time_phrase::TimePhrase;
use crate::tokens::WordSpan;

/// Referring expression: one noun phrase, or several joined by "and" or "or".
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ReferringExpression {
    pub(crate) phrases: Vec<NounPhrase>,
    /// True for "the mug or the box", of which one is enough.
    pub(crate) is_alternative: bool,
}

/// Noun phrase: "the two red mugs left of the box".
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct NounPhrase {
    /// All words of the phrase.
    pub(crate) span: WordSpan,
    pub(crate) quantity: Quantity,
    pub(crate) noun: Noun,
    /// True for "mugs", but not for a category that is taught as "pop-tarts".
    pub(crate) is_plural: bool,
    /// True for "the shiny thing", where a word before "thing" was not understood.
    pub(crate) is_vague: bool,
    pub(crate) restrictions: Vec<Restriction>,
    /// Applied one after the other, after all restrictions.
    pub(crate) rankings: Vec<Ranking>,
}

/// Number of objects that a noun phrase refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Quantity {
    /// No determiner: one object for "mug", all for "mugs".
    #[default]
    Open,
    /// "the": exactly one is expected, unless the noun is plural.
    The,
    /// "a", "any": one of those that fit.
    Any,
    /// "all", "every", "both" with its number.
    All(Option<usize>),
    /// "two", "the three".
    Exactly(usize),
}

/// Noun of a phrase.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Noun {
    /// "thing", or no noun.
    #[default]
    Anything,
    /// Words that should name a category.
    Category(WordSpan),
}

/// Restriction of a noun phrase, with the words that express it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Restriction {
    /// Words of the restriction itself, without those of a landmark.
    pub(crate) span: WordSpan,
    pub(crate) is_negated: bool,
    pub(crate) kind: RestrictionKind,
}

/// Property or relation that an object must have.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum RestrictionKind {
    Color(ColorPhrase),
    /// "big", relative to the objects that fit the rest of the phrase.
    Size(Dimension, Degree),
    /// "bigger than the mug".
    SizeThan(Dimension, Degree, Box<NounPhrase>),
    /// "about 20 cm tall".
    Measure(Dimension, Bound, f64),
    /// "left of the box".
    Relation(Relation, Box<NounPhrase>),
    /// "between the box and the mug".
    Between(Box<[NounPhrase; 2]>),
    /// "on the left", of the table or of the candidates.
    Place(TablePlace),
    /// "on the left of the table".
    Region(TablePlace),
    /// "labelled".
    Labelled,
    /// "in view".
    InView,
    /// "missing".
    Gone,
    /// "that Anna taught you yesterday".
    Taught(LessonAuthor, Option<TimePhrase>),
    /// "that you saw yesterday".
    Seen(TimePhrase),
    /// "that appeared this morning".
    Appeared(TimePhrase),
    /// Identity with a phrase, for "except the mug".
    Is(Box<NounPhrase>),
}

/// Colours of an object.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum ColorPhrase {
    /// "red or blue": one of them.
    Any(Vec<Shade>),
    /// "red and white": all of them.
    All(Vec<Shade>),
    /// "colourful".
    Many,
}

/// Author of a lesson.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LessonAuthor {
    /// "I": the speaker, if known.
    Speaker,
    /// A person's name.
    Named(WordSpan),
    /// Anybody, as in "taught yesterday".
    Anyone,
}

/// Selection by rank: "the second mug from the left".
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ranking {
    pub(crate) span: WordSpan,
    pub(crate) key: RankingKey,
    /// 1 for the first.
    pub(crate) rank: usize,
}

/// Key by which candidates are ranked.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum RankingKey {
    Size(Dimension, Degree),
    Leftmost,
    Rightmost,
    /// Nearest to the viewer along the view, whatever the distance.
    Frontmost,
    Rearmost,
    Nearest,
    Farthest,
    NearestTo(Box<NounPhrase>),
    FarthestFrom(Box<NounPhrase>),
    Topmost,
    Lowest,
    /// Latest first view.
    Newest,
    /// Earliest first view.
    Oldest,
    /// Latest view.
    LastSeen,
}

impl NounPhrase {
    /// True if the phrase asks for one object.
    pub(crate) fn wants_one(&self) -> bool {
        match self.quantity {
            Quantity::All(_) => false,
            Quantity::Exactly(n) => n == 1,
            Quantity::Any | Quantity::Open | Quantity::The => !self.is_plural,
        }
    }

    /// True if the phrase asks for objects that are gone.
    pub(crate) fn wants_gone(&self) -> bool {
        let mut restrictions = self.restrictions.iter();
        restrictions.any(|one| one.kind == RestrictionKind::Gone && !one.is_negated)
    }

    /// True if a restriction names what an object keeps when it is taken away.
    pub(crate) fn has_lasting_property(&self) -> bool {
        self.restrictions.iter().any(|one| {
            !one.is_negated
                && matches!(
                    one.kind,
                    RestrictionKind::Color(_)
                        | RestrictionKind::Size(..)
                        | RestrictionKind::SizeThan(..)
                        | RestrictionKind::Measure(..)
                        | RestrictionKind::Taught(..)
                        | RestrictionKind::Seen(_)
                        | RestrictionKind::Appeared(_)
                )
        })
    }

    /// Side by which the candidates may be compared: "the mug on the left".
    pub(crate) fn compared_side(&self) -> Option<TablePlace> {
        let is_definite = matches!(self.quantity, Quantity::The | Quantity::Open);
        let has_candidates = self.noun != Noun::Anything || self.restrictions.len() > 1;
        let is_size = |one: &Restriction| matches!(one.kind, RestrictionKind::Size(..));
        let mut sides = self.restrictions.iter().filter_map(|one| match one.kind {
            RestrictionKind::Place(place) => Some((place, one.is_negated)),
            _ => None,
        });
        let (place, is_negated) = sides.next()?;
        let is_compared = is_definite
            && self.wants_one()
            && has_candidates
            && self.rankings.is_empty()
            && !self.restrictions.iter().any(is_size)
            && sides.next().is_none()
            && !is_negated;
        is_compared.then_some(place)
    }

    /// Other attachment of the last landmark's own restrictions: to this phrase.
    ///
    /// "The mug left of (the box behind the bottle)" becomes "the mug left of the box, behind the
    /// bottle". None if no landmark has a restriction.
    pub(crate) fn reattached(&self) -> Option<Self> {
        let mut phrase = self.clone();
        let mut raised = None;
        for restriction in phrase.restrictions.iter_mut().rev() {
            if let Some(landmark) = restriction.kind.last_landmark()
                && (!landmark.restrictions.is_empty() || !landmark.rankings.is_empty())
            {
                raised = Some((
                    std::mem::take(&mut landmark.restrictions),
                    std::mem::take(&mut landmark.rankings),
                ));
                break;
            }
        }
        let (restrictions, rankings) = raised?;
        phrase.restrictions.extend(restrictions);
        phrase.rankings.extend(rankings);
        Some(phrase)
    }
}

impl RestrictionKind {
    /// False for a restriction that nearly all objects of a table fulfil.
    pub(crate) fn excludes_objects(&self) -> bool {
        !matches!(self, Self::Place(TablePlace::Anywhere) | Self::InView)
    }

    fn last_landmark(&mut self) -> Option<&mut NounPhrase> {
        match self {
            Self::SizeThan(_, _, landmark) | Self::Relation(_, landmark) => Some(landmark),
            Self::Between(landmarks) => Some(&mut landmarks[1]),
            _ => None,
        }
    }
}
