//! Extremes of place: "on the far left", "furthest back", "at the very front".

use super::{Draft, Parser};
use crate::expression::RankingKey;
use crate::vocabulary::{
    self, EXTREME_DEGREES, EXTREME_ENDS, EXTREME_OPENINGS, EXTREME_SIDES, SUPPORTS,
};

impl Parser<'_> {
    /// Reads an extreme of place as a rank: it means one object, unless the noun is plural.
    pub(super) fn extreme_place(&mut self, draft: &mut Draft) -> bool {
        if draft.phrase.is_plural {
            return false;
        }
        let Some((key, n_words)) = self.extreme_here() else {
            return false;
        };
        let is_adjective = n_words <= 2;
        let span = self.pass(n_words, "an extreme place");
        self.pass_of_table();
        draft.has_postmodifier |= !is_adjective;
        Self::rank(draft, span, key)
    }

    /// Side of an extreme here, with the number of words; None before a landmark or inside a name.
    fn extreme_here(&self) -> Option<(RankingKey, usize)> {
        let mut n_words = self.n_words_at(0, &EXTREME_OPENINGS);
        let n_degree = self.n_words_at(n_words, &EXTREME_DEGREES);
        let is_distance = matches!(self.word_at(n_words), "closest" | "nearest");
        n_words += n_degree;
        let n_opening = self.n_words_at(n_words, &EXTREME_OPENINGS);
        if n_degree == 0 || is_distance && n_opening == 0 {
            return None;
        }
        n_words += n_opening;
        let is_name = self.is_name_after(n_words);
        let after = self.rest().get(n_words..).unwrap_or_default();
        let (key, n_side) = vocabulary::longest(&EXTREME_SIDES, after)?;
        n_words += n_side;
        n_words += self.n_words_at(n_words, &EXTREME_ENDS);
        let rest = self.rest().get(n_words..).unwrap_or_default();
        let is_of = self.word_at(n_words) == "of";
        let support = rest.get(1..).unwrap_or_default();
        let is_of_table = is_of && vocabulary::longest(&SUPPORTS, support).is_some();
        let is_relation = is_of && !is_of_table;
        let is_before_noun = is_distance && !rest.is_empty() && !is_of;
        (!is_name && !is_relation && !is_before_noun).then(|| (key.clone(), n_words))
    }

    fn word_at(&self, position: usize) -> &str {
        self.rest()
            .get(position)
            .map_or("", |word| word.word.as_str())
    }

    /// Number of words of the longest phrase of a table, some words ahead.
    fn n_words_at(&self, position: usize, table: &[(&str, ())]) -> usize {
        let words = self.rest().get(position..).unwrap_or_default();
        vocabulary::longest(table, words).map_or(0, |((), n_words)| n_words)
    }
}
