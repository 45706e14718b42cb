//! Single words of all tables, for telling a misspelt word from one that has a meaning.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use super::{
    ACKNOWLEDGEMENTS, ADJECTIVES, BETWEEN, BOUNDS, COLOR_MODIFIERS, COLOR_SUFFIXES, COUNTED_TIMES,
    COUNTING_SIDES, DETERMINERS, EXCEPTIONS, EXTREME_DEGREES, EXTREME_ENDS, EXTREME_OPENINGS,
    EXTREME_SIDES, GENERIC_NOUNS, INDEFINITES, JOINTS, LABELS, LENGTH_UNITS, MANY_COLORS,
    MEASURED_DIMENSIONS, NEGATIONS, NUMERALS, ORDINALS, PLACES, PRESENCES, RANKINGS,
    RELATION_MODIFIERS, RELATIONS, SUPPORTS, TEACHING_VERBS, TIME_UNITS, TIMES, VISIBILITY, WITHIN,
    WRAPPERS,
};
use crate::shade::shade_words;

/// Words of phrases that no table has.
const OTHER_WORDS: &str = "and or between halfway midway nor by than i you me we it my your their \
    have has had just did already very so there somebody someone they people i've \
    seen saw last appeared came arrived first ago earlier before";

/// Words of everyday English that have no meaning for a query and are not misspelt.
const ORDINARY_WORDS: &str = "round square cold warm hot cool old heavy hard soft nice fine wooden \
    wood broken metal metallic plastic paper cardboard steel iron empty full clean dirty dusty \
    shiny matte striped dotted spotted checked sharp fresh rough smooth wet dry cheap good bad best \
    better worst same other another different favourite favorite usual ugly pretty sweet bitter \
    sour salty closed open expensive loud main many much few more most less least only even here \
    when while how why whom lovely great handy funny curved straight bent angular oval pointed \
    transparent clear opaque fragile living real fake used unused both either neither each \
    other's now then soon maybe perhaps also again could should would might must can cannot can't \
    don't doesn't am be being do does done its his her hers him them us our ours mine yours theirs \
    bought brought belong belongs like likes liked love loves loved want wants wanted need needs \
    taste tastes smell smells look looks use uses borrowed broke broken found keep keeps kept leave \
    made makes drink drinks eat eats ate drank prefer prefers hate hates own owns owned gave given \
    got as if because until since through across along against among amongst toward towards beyond \
    off out up down top bottom edge corner end half whole pair set kind sort type brand make made \
    wearing holding carrying using facing looking going moving hanging leaning floating standing \
    no yes not never ever always sometimes often hi hey ok okay hello dear sir madam";

/// Words that a phrase of some table contains, in lower case.
static WORDS: LazyLock<BTreeSet<&'static str>> = LazyLock::new(|| {
    let mut words: BTreeSet<&'static str> = OTHER_WORDS.split_whitespace().collect();
    words.extend(shade_words());
    words.extend(COLOR_MODIFIERS);
    add(&mut words, &DETERMINERS);
    add(&mut words, &NUMERALS);
    add(&mut words, &ORDINALS);
    add(&mut words, &GENERIC_NOUNS);
    add(&mut words, &MANY_COLORS);
    add(&mut words, &COLOR_SUFFIXES);
    add(&mut words, &NEGATIONS);
    add(&mut words, &EXCEPTIONS);
    add(&mut words, &INDEFINITES);
    add(&mut words, &LABELS);
    add(&mut words, &VISIBILITY);
    add(&mut words, &PRESENCES);
    add(&mut words, &BETWEEN);
    add(&mut words, &RELATIONS);
    add(&mut words, &RELATION_MODIFIERS);
    add(&mut words, &SUPPORTS);
    add(&mut words, &PLACES);
    add(&mut words, &RANKINGS);
    add(&mut words, &COUNTING_SIDES);
    add(&mut words, &EXTREME_OPENINGS);
    add(&mut words, &EXTREME_DEGREES);
    add(&mut words, &EXTREME_SIDES);
    add(&mut words, &EXTREME_ENDS);
    add(&mut words, &ACKNOWLEDGEMENTS);
    add(&mut words, &JOINTS);
    add(&mut words, &WRAPPERS);
    add(&mut words, &ADJECTIVES);
    add(&mut words, &BOUNDS);
    add(&mut words, &LENGTH_UNITS);
    add(&mut words, &MEASURED_DIMENSIONS);
    add(&mut words, &COUNTED_TIMES);
    add(&mut words, &TEACHING_VERBS);
    add(&mut words, &TIME_UNITS);
    add(&mut words, &TIMES);
    add(&mut words, &WITHIN);
    words
});

/// Everyday words without a meaning for a query.
static ORDINARY: LazyLock<BTreeSet<&'static str>> =
    LazyLock::new(|| ORDINARY_WORDS.split_whitespace().collect());

fn add<T>(words: &mut BTreeSet<&'static str>, table: &[(&'static str, T)]) {
    words.extend(table.iter().flat_map(|(phrase, _)| phrase.split(' ')));
}

/// Words of the vocabulary, ascending.
pub(crate) fn words() -> impl Iterator<Item = &'static str> {
    WORDS.iter().copied()
}

/// True if a phrase of some table contains the word.
pub(crate) fn is_word(word: &str) -> bool {
    WORDS.contains(word)
}

/// True if the word is English, and neither a noun nor of the vocabulary.
pub(crate) fn is_ordinary(word: &str) -> bool {
    ORDINARY.contains(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vocabulary_words_are_single() {
        assert!(is_word("left") && is_word("crimson") && is_word("yesterday"));
        assert!(!is_word("mug") && words().all(|word| !word.contains(' ')));
        assert!(is_ordinary("round") && !is_ordinary("left"));
    }
}
