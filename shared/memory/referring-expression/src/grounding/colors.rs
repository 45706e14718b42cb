//! Colours: shares of the basic terms against the colours that were asked for.

use super::{Grounder, Judgement, Rating};
use crate::ColorTerm;
use crate::expression::{ColorPhrase, Restriction};
use crate::relation::ramp;
use crate::shade::Shade;
use crate::world::WorldObject;

/// Share from which on an object has a colour fully. Chosen.
const CLEAR_SHARE: f64 = 0.5;

/// Share from which on an object has a colour without doubt. Chosen: colours that border on each
/// other, such as red and purple, share an object by about half.
const SURE_SHARE: f64 = 0.6;

/// Share from which on one of several colours counts without doubt. Chosen.
const CLEAR_PART: f64 = 0.2;

/// Share of a colour that a person notices. Chosen.
const NOTICED_SHARE: f64 = 0.12;

/// Share with which the only object of a noun has a colour. Chosen: a quarter is seen.
const FAIR_SHARE: f64 = 0.25;

/// Score of that object: with the one of a part of its name it still fits. Chosen.
const FAIR_SCORE: f64 = 0.6;

/// Score of an object whose colour is not known.
const UNKNOWN_SCORE: f64 = 0.4;

impl Grounder<'_> {
    /// Judges the colours. The only object of a noun fits with a doubt if it has a fair share.
    pub(super) fn judge_color(
        &mut self,
        color: &ColorPhrase,
        restriction: &Restriction,
        ratings: &[Rating],
    ) -> Vec<Judgement> {
        let (ColorPhrase::Any(shades) | ColorPhrase::All(shades)) = color else {
            return self.world.objects.iter().map(judge_many).collect();
        };
        if shades.iter().any(|shade| shade.is_mapped) {
            let terms: Vec<_> = shades.iter().map(shade_text).collect();
            let words = self.text(restriction.span);
            self.doubt(format!("`{words}` was taken as {}", terms.join(" and ")));
        }
        let judge = |object| match color {
            ColorPhrase::All(_) => judge_all(object, shades),
            _ => judge_any(object, shades),
        };
        let mut judgements: Vec<Judgement> = self.world.objects.iter().map(judge).collect();
        if let Some(only) = self.only_candidate(ratings)
            && matches!(color, ColorPhrase::Any(_))
            && !restriction.is_negated
            && judgements[only].nearness >= FAIR_SHARE
        {
            judgements[only].score = judgements[only].score.max(FAIR_SCORE);
        }
        judgements
    }

    /// The only object of the scope that has the category of the noun.
    fn only_candidate(&self, ratings: &[Rating]) -> Option<usize> {
        let is_candidate = |index: &usize| {
            ratings[*index].has_category && self.scope.contains(&self.world.objects[*index])
        };
        let mut candidates = (0..ratings.len()).filter(is_candidate);
        let only = candidates.next()?;
        let is_named = !ratings[only].fits.is_empty();
        (is_named && candidates.next().is_none()).then_some(only)
    }
}

fn shade_text(shade: &Shade) -> String {
    let terms: Vec<_> = shade.terms.iter().map(|term| term.word()).collect();
    terms.join(" or ")
}

fn shares(object: &WorldObject) -> [f64; 11] {
    object.color_shares.map(|share| {
        let share = f64::from(share);
        if share.is_finite() {
            share.clamp(0.0, 1.0)
        } else {
            0.0
        }
    })
}

/// True if the colour of an object is known.
pub(super) fn has_known_color(object: &WorldObject) -> bool {
    is_known(&shares(object))
}

fn is_known(shares: &[f64; 11]) -> bool {
    shares.iter().sum::<f64>() > NOTICED_SHARE
}

/// Share of a shade: of all terms that it may stand for.
fn share_of(shade: &Shade, shares: &[f64; 11]) -> f64 {
    let terms = ColorTerm::ALL.iter().zip(shares);
    terms
        .filter(|(term, _)| shade.terms.contains(term))
        .map(|(_, share)| share)
        .sum()
}

fn unknown(object: &WorldObject, wanted: &str) -> Judgement {
    Judgement::new(
        UNKNOWN_SCORE,
        format!("may be {wanted}"),
        "has no known colour",
    )
    .doubt_if(true, || {
        format!("the colour of track {} is not known", object.track_id)
    })
}

/// Colour of the largest share.
fn main_color(shares: &[f64; 11]) -> &'static str {
    let terms = ColorTerm::ALL.iter().zip(shares);
    let largest = terms.max_by(|a, b| a.1.total_cmp(b.1));
    largest.map_or("without colour", |(term, _)| term.word())
}

fn judge_any(object: &WorldObject, shades: &[Shade]) -> Judgement {
    let shares = shares(object);
    let texts: Vec<_> = shades.iter().map(shade_text).collect();
    let wanted = texts.join(" or ");
    if !is_known(&shares) {
        return unknown(object, &wanted);
    }
    let best = shades
        .iter()
        .map(|shade| share_of(shade, &shares))
        .fold(0.0, f64::max);
    let main = main_color(&shares);
    let is_main = texts.iter().any(|text| text == main);
    let lack = if is_main {
        format!("is only {:.0} % {wanted}", 100.0 * best)
    } else {
        format!("is {main}")
    };
    let score = ramp(best, NOTICED_SHARE, CLEAR_SHARE);
    let judgement = Judgement::new(score, format!("is {wanted}"), lack);
    let judgement = Judgement {
        nearness: best,
        ..judgement
    };
    judgement.doubt_if((NOTICED_SHARE..SURE_SHARE).contains(&best), || {
        format!(
            "track {} is only {:.0} % {wanted}",
            object.track_id,
            100.0 * best
        )
    })
}

fn judge_all(object: &WorldObject, shades: &[Shade]) -> Judgement {
    let shares = shares(object);
    let texts: Vec<_> = shades.iter().map(shade_text).collect();
    let wanted = texts.join(" and ");
    if !is_known(&shares) {
        return unknown(object, &wanted);
    }
    let least = shades
        .iter()
        .map(|shade| share_of(shade, &shares))
        .fold(1.0, f64::min);
    let score = ramp(least, 0.25 * NOTICED_SHARE, CLEAR_PART);
    let lack = format!("is not {wanted}, but mainly {}", main_color(&shares));
    Judgement::new(score, format!("is {wanted}"), lack).doubt_if(least < CLEAR_PART, || {
        format!(
            "track {} has only {:.0} % of one of the colours {wanted}",
            object.track_id,
            100.0 * least
        )
    })
}

fn judge_many(object: &WorldObject) -> Judgement {
    let shares = shares(object);
    if !is_known(&shares) {
        return unknown(object, "of many colours");
    }
    let n_colors = shares.iter().filter(|share| **share >= 0.12).count();
    let score = ramp(n_colors as f64, 1.0, 3.0);
    Judgement::new(
        score,
        "is of many colours",
        format!("is mainly {}", main_color(&shares)),
    )
    .doubt_if(n_colors == 2, || {
        format!("track {} has only two colours", object.track_id)
    })
}
