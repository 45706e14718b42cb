//! Modifiers of a noun: colours, sizes, measures, ranks, relations, places and negation.

use super::{Draft, Parser};
use crate::expression::{ColorPhrase, Noun, NounPhrase, Ranking, RankingKey, RestrictionKind};
use crate::relation::{Relation, TablePlace};
use crate::shade::{Shade, shade};
use crate::size::{AdjectiveForm, Bound, Degree, Dimension};
use crate::tokens::WordSpan;
use crate::vocabulary::{
    self, ADJECTIVES, BETWEEN, BOUNDS, COLOR_MODIFIERS, COLOR_SUFFIXES, COUNTING_SIDES, EXCEPTIONS,
    LABELS, LENGTH_UNITS, MANY_COLORS, MEASURED_DIMENSIONS, ORDINALS, PLACES, PRESENCES, RANKINGS,
    RELATION_MODIFIERS, RELATIONS, SUPPORTS, VISIBILITY,
};

impl Parser<'_> {
    /// Reads one modifier.
    pub(super) fn modifier(&mut self, draft: &mut Draft) -> bool {
        self.clause(draft)
            || self.knowledge(draft)
            || self.exception(draft)
            || self.measure(draft)
            || self.extreme_place(draft)
            || self.modified_relation(draft)
            || self.ranking(draft)
            || self.between(draft)
            || self.relation_or_place(draft)
            || self.color(draft)
            || self.size(draft)
            || self.negation(draft)
    }

    /// Reads "unlabelled" or "in view".
    fn knowledge(&mut self, draft: &mut Draft) -> bool {
        let (is_positive, span, kind) =
            if let Some((is_labelled, span)) = self.take(&LABELS, "a restriction by label") {
                (is_labelled, span, RestrictionKind::Labelled)
            } else if let Some((is_seen, span)) = self.take(&VISIBILITY, "a restriction by view") {
                (is_seen, span, RestrictionKind::InView)
            } else if let Some(((), span)) = self.take(&PRESENCES, "an object that is gone") {
                (true, span, RestrictionKind::Gone)
            } else {
                return false;
            };
        draft.is_negated ^= !is_positive;
        Self::restrict(draft, span, kind)
    }

    /// Reads "except the mug".
    fn exception(&mut self, draft: &mut Draft) -> bool {
        let checkpoint = self.checkpoint();
        let Some(span) = self.exception_word(draft) else {
            return false;
        };
        let Some(phrase) = self.landmark() else {
            return self.restore(&checkpoint);
        };
        draft.is_negated = true;
        draft.has_postmodifier = true;
        Self::restrict(draft, span, RestrictionKind::Is(Box::new(phrase)));
        while matches!(self.next_word(), "and" | "or") && self.further_exception(draft, span) {}
        true
    }

    /// Passes "except", or "but" between "everything" and a name.
    fn exception_word(&mut self, draft: &Draft) -> Option<WordSpan> {
        if let Some(((), span)) = self.take(&EXCEPTIONS, "an exception") {
            return Some(span);
        }
        let after = self.rest().get(1..).unwrap_or_default();
        let is_exception = self.next_word() == "but"
            && draft.phrase.noun == Noun::Anything
            && self.names.longest_at_start(after).is_some();
        is_exception.then(|| self.pass(1, "an exception"))
    }

    /// Reads "and the bottle" after "except the mug".
    pub(super) fn further_exception(&mut self, draft: &mut Draft, span: WordSpan) -> bool {
        let checkpoint = self.checkpoint();
        self.pass(1, "a further exception");
        let Some(phrase) = self.landmark() else {
            return self.restore(&checkpoint);
        };
        draft.is_negated = true;
        Self::restrict(draft, span, RestrictionKind::Is(Box::new(phrase)))
    }

    /// Reads "light red", "red and white", "red or blue", "colourful".
    fn color(&mut self, draft: &mut Draft) -> bool {
        if let Some(((), span)) = self.take(&MANY_COLORS, "of many colours") {
            return Self::restrict(draft, span, RestrictionKind::Color(ColorPhrase::Many));
        }
        let start = self.position;
        let Some(first) = self.shade() else {
            return false;
        };
        let mut shades = vec![first];
        let mut is_alternative = false;
        while let Some((next, has_or)) = self.further_shade() {
            is_alternative |= has_or;
            shades.push(next);
        }
        self.take(&COLOR_SUFFIXES, "a colour");
        let span = WordSpan {
            start,
            end: self.position,
        };
        let color = if is_alternative || shades.len() == 1 {
            ColorPhrase::Any(shades)
        } else {
            ColorPhrase::All(shades)
        };
        Self::restrict(draft, span, RestrictionKind::Color(color))
    }

    /// Reads a colour with its modifiers.
    fn shade(&mut self) -> Option<Shade> {
        let is_modifier =
            |w: &&crate::tokens::SpokenWord| COLOR_MODIFIERS.contains(&w.word.as_str());
        let n_modifiers = self.rest().iter().take_while(is_modifier).count();
        let color = shade(&self.rest().get(n_modifiers)?.word)?;
        if n_modifiers > 0 && self.is_name_after(n_modifiers) {
            return None;
        }
        if n_modifiers > 0 {
            let span = self.pass(n_modifiers, "a modifier of the colour, not used");
            let words = span.text(self.words);
            self.remarks
                .push(format!("the modifier `{words}` was not used"));
        }
        let terms: Vec<_> = color.terms.iter().map(|term| term.word()).collect();
        self.pass(1, format!("the colour {}", terms.join(" or ")));
        Some(color)
    }

    /// True if a name of several words stands some words ahead.
    pub(super) fn is_name_after(&self, n_words: usize) -> bool {
        let after = self.rest().get(n_words..).unwrap_or_default();
        self.names.longest_at_start(after) > Some(1)
    }

    /// Reads "and white" or "or blue", or one more colour; true for "or".
    fn further_shade(&mut self) -> Option<(Shade, bool)> {
        let checkpoint = self.checkpoint();
        let joint = self.next_word();
        if matches!(joint, "and" | "or") {
            self.pass(1, if joint == "or" { "either" } else { "both" });
        }
        // A category may have the name of a colour: "the red orange".
        let is_noun = self.is_name_here();
        let found = if is_noun { None } else { self.shade() };
        if found.is_none() {
            self.restore(&checkpoint);
        }
        Some((found?, joint == "or"))
    }

    /// Reads "big", "bigger than the mug", "biggest".
    fn size(&mut self, draft: &mut Draft) -> bool {
        let checkpoint = self.checkpoint();
        let Some(((dimension, degree, form), span)) = self.take(&ADJECTIVES, "a size") else {
            return false;
        };
        match form {
            AdjectiveForm::Positive => {
                Self::restrict(draft, span, RestrictionKind::Size(dimension, degree))
            }
            AdjectiveForm::Comparative if self.next_word() == "than" => {
                self.pass(1, "a comparison");
                self.comparison(draft, span, (dimension, degree)) || self.restore(&checkpoint)
            }
            AdjectiveForm::Comparative | AdjectiveForm::Superlative => {
                Self::rank(draft, span, RankingKey::Size(dimension, degree));
                self.pass_of_several();
                true
            }
        }
    }

    /// Passes "of the two" after "the bigger".
    fn pass_of_several(&mut self) {
        let openings = [
            ("of the", ()),
            ("of these", ()),
            ("of all the", ()),
            ("of", ()),
        ];
        if self.take(&openings, "a determiner").is_some() {
            self.take(&vocabulary::NUMERALS, "a number");
        }
    }

    /// Reads "10 cm" or "the mug" after "bigger than".
    fn comparison(
        &mut self,
        draft: &mut Draft,
        span: WordSpan,
        (dimension, degree): (Dimension, Degree),
    ) -> bool {
        if let Some(measure_m) = self.length_m() {
            let bound = match degree {
                Degree::More => Bound::More,
                Degree::Less => Bound::Less,
            };
            let measured = if dimension == Dimension::Volume {
                Dimension::Extent
            } else {
                dimension
            };
            let kind = RestrictionKind::Measure(measured, bound, measure_m);
            return Self::restrict(draft, span, kind);
        }
        let is_negated = draft.is_negated;
        let Some(landmark) = self.landmark() else {
            return false;
        };
        draft.is_negated = is_negated;
        draft.has_postmodifier = true;
        let kind = RestrictionKind::SizeThan(dimension, degree, Box::new(landmark));
        Self::restrict(draft, span, kind)
    }

    /// Reads a length with its unit, in metres.
    fn length_m(&mut self) -> Option<f64> {
        let number = self.next_word().parse::<f64>().ok().or_else(|| {
            let (count, n_words) = vocabulary::longest(&vocabulary::NUMERALS, self.rest())?;
            (n_words == 1).then_some(*count as f64)
        })?;
        let after = self.rest().get(1..).unwrap_or_default();
        let (unit_m, n_words) = vocabulary::longest(&LENGTH_UNITS, after)?;
        let measure_m = number * unit_m;
        (measure_m.is_finite() && measure_m >= 0.0).then(|| {
            self.pass(1 + n_words, format!("a length of {measure_m:.3} m"));
            measure_m
        })
    }

    /// Reads "about 20 cm tall".
    fn measure(&mut self, draft: &mut Draft) -> bool {
        let checkpoint = self.checkpoint();
        let start = self.position;
        let bound = self
            .take(&BOUNDS, "a bound")
            .map_or(Bound::About, |taken| taken.0);
        let Some(measure_m) = self.length_m() else {
            return self.restore(&checkpoint);
        };
        let dimension = self
            .take(&MEASURED_DIMENSIONS, "the measured dimension")
            .map_or(Dimension::Extent, |taken| taken.0);
        let span = WordSpan {
            start,
            end: self.position,
        };
        let kind = RestrictionKind::Measure(dimension, bound, measure_m);
        Self::restrict(draft, span, kind)
    }

    /// Reads "leftmost", "nearest to the box", "second", "from the right".
    fn ranking(&mut self, draft: &mut Draft) -> bool {
        if self.ranking_landmark(draft) {
            return true;
        }
        if let Some((key, span)) = self.take(&RANKINGS, "a rank") {
            return Self::rank(draft, span, key);
        }
        if draft.ordinal.is_none()
            && let Some(ordinal) = self.take(&ORDINALS, "an ordinal number")
        {
            draft.ordinal = Some(ordinal);
            return true;
        }
        if draft.ordinal.is_some()
            && let Some((key, span)) = self.take(&COUNTING_SIDES, "the side to count from")
        {
            draft.has_postmodifier = true;
            return Self::rank(draft, span, key);
        }
        false
    }

    /// Adds a rank; "not the leftmost" excludes the object of that rank.
    pub(super) fn rank(draft: &mut Draft, span: WordSpan, key: RankingKey) -> bool {
        let rank = draft.ordinal.take().map_or(1, |(rank, _)| rank);
        let ranking = Ranking { span, key, rank };
        if draft.is_negated {
            let of_rank = NounPhrase {
                span,
                noun: draft.phrase.noun,
                rankings: vec![ranking],
                ..NounPhrase::default()
            };
            return Self::restrict(draft, span, RestrictionKind::Is(Box::new(of_rank)));
        }
        draft.phrase.rankings.push(ranking);
        true
    }

    /// Reads "to the box" after "nearest", "from the box" after "farthest".
    fn ranking_landmark(&mut self, draft: &mut Draft) -> bool {
        let preposition = self.next_word();
        let Some(ranking) = draft.phrase.rankings.last_mut() else {
            return false;
        };
        let is_nearest = match (&ranking.key, preposition) {
            (RankingKey::Nearest, "to") => true,
            (RankingKey::Farthest, "from") => false,
            _ => return false,
        };
        let checkpoint = self.checkpoint();
        self.pass(1, "a landmark");
        let Some(landmark) = self.landmark().map(Box::new) else {
            return self.restore(&checkpoint);
        };
        draft.has_postmodifier = true;
        ranking.key = if is_nearest {
            RankingKey::NearestTo(landmark)
        } else {
            RankingKey::FarthestFrom(landmark)
        };
        true
    }

    /// Reads "directly behind the box"; how directly is not judged.
    fn modified_relation(&mut self, draft: &mut Draft) -> bool {
        let checkpoint = self.checkpoint();
        if self.has(&RELATIONS) || self.has(&BETWEEN) {
            return false;
        }
        let meaning = "a modifier of the relation, not used";
        let Some(((), span)) = self.take(&RELATION_MODIFIERS, meaning) else {
            return false;
        };
        let is_relation = self.has(&RELATIONS) || self.has(&BETWEEN) || self.has(&PLACES);
        if !is_relation || !(self.between(draft) || self.relation_or_place(draft)) {
            return self.restore(&checkpoint);
        }
        let words = span.text(self.words);
        self.remarks
            .push(format!("the modifier `{words}` was not used"));
        true
    }

    /// Reads "left of the box" or "on the left", by the longer phrase.
    fn relation_or_place(&mut self, draft: &mut Draft) -> bool {
        let relation = vocabulary::longest(&RELATIONS, self.rest());
        let place = vocabulary::longest(&PLACES, self.rest());
        let n_relation = relation.map_or(0, |(_, n_words)| n_words);
        match (relation, place) {
            (Some((relation, _)), _) if place.is_none_or(|(_, n)| n <= n_relation) => {
                self.relation(draft, *relation, n_relation)
            }
            (_, Some((place, n_words))) => self.place(draft, *place, n_words),
            _ => false,
        }
    }

    fn relation(&mut self, draft: &mut Draft, relation: Relation, n_words: usize) -> bool {
        let checkpoint = self.checkpoint();
        let span = self.pass(n_words, format!("the relation \"{}\"", relation.word()));
        if self.has(&SUPPORTS) && !self.is_support_known() {
            self.take(&SUPPORTS, "the table");
            draft.has_postmodifier = true;
            return Self::restrict(draft, span, place_on_support(relation));
        }
        let Some(landmark) = self.landmark() else {
            return self.restore(&checkpoint);
        };
        draft.has_postmodifier = true;
        let kind = RestrictionKind::Relation(relation, Box::new(landmark));
        Self::restrict(draft, span, kind)
    }

    /// True if a category has the name of a support.
    fn is_support_known(&self) -> bool {
        let words = self.rest();
        let start = usize::from(matches!(self.next_word(), "the" | "this"));
        let name = words.get(start..).unwrap_or_default();
        self.names.longest_at_start(name).is_some()
    }

    /// Passes "of the table".
    pub(super) fn pass_of_table(&mut self) -> bool {
        let checkpoint = self.checkpoint();
        self.take(&[("of", ())], "a joint").is_some()
            && (self.take(&SUPPORTS, "the table").is_some() || self.restore(&checkpoint))
    }

    fn place(&mut self, draft: &mut Draft, place: TablePlace, n_words: usize) -> bool {
        let is_adjective = n_words == 1;
        let is_support = place == TablePlace::Anywhere;
        let name = self.rest().get(n_words - 1..).unwrap_or_default();
        if is_support && self.names.longest_at_start(name).is_some() {
            // A table that was taught is a landmark.
            return self.relation(draft, Relation::On, 1);
        }
        let span = self.pass(n_words, format!("the place \"{}\"", place.word()));
        draft.has_postmodifier |= !is_adjective;
        let kind = if self.pass_of_table() {
            RestrictionKind::Region(place)
        } else {
            RestrictionKind::Place(place)
        };
        Self::restrict(draft, span, kind)
    }
}

/// Place that a relation to the table means.
fn place_on_support(relation: Relation) -> RestrictionKind {
    RestrictionKind::Region(match relation {
        Relation::LeftOf => TablePlace::Left,
        Relation::RightOf => TablePlace::Right,
        Relation::Behind => TablePlace::Back,
        Relation::InFrontOf => TablePlace::Front,
        _ => return RestrictionKind::Place(TablePlace::Anywhere),
    })
}
