//! Robustness: any query ends, and each of its words is accounted for.

use proptest::prelude::*;

use super::*;
use crate::tokens::tokenize;
use crate::{Error, QUERY_CHARACTERS_MAX};

/// Words of which queries are made, so that the grammar is reached.
const WORDS: [&str; 60] = [
    "the",
    "a",
    "all",
    "two",
    "red",
    "blue",
    "not",
    "mug",
    "mugs",
    "box",
    "cereal",
    "bottle",
    "left",
    "of",
    "right",
    "behind",
    "in",
    "front",
    "between",
    "and",
    "or",
    "on",
    "under",
    "next",
    "to",
    "bigger",
    "than",
    "biggest",
    "second",
    "from",
    "nearest",
    "that",
    "is",
    "which",
    "with",
    "without",
    "label",
    "except",
    "Anna",
    "taught",
    "you",
    "yesterday",
    "I",
    "showed",
    "minutes",
    "ago",
    "10",
    "cm",
    "tall",
    "about",
    "shiny",
    "please",
    "where",
    "one",
    "orange",
    "middle",
    "last",
    "seen",
    "far",
    "dark",
];

#[track_caller]
fn check_words(query: &str, answer: &Answer) {
    let used = answer
        .understood
        .iter()
        .flat_map(|used| used.words.split(' '));
    let ignored = answer.not_understood.iter().map(String::as_str);
    let mut accounted: Vec<&str> = used.chain(ignored).collect();
    let tokens = tokenize(query);
    let mut words: Vec<&str> = tokens.iter().map(|token| token.text.as_str()).collect();
    accounted.sort_unstable();
    words.sort_unstable();
    assert_eq!(accounted, words, "{query}");
}

proptest! {
    #[test]
    fn parser_accounts_for_each_word_of_any_text(query in ".{0,80}") {
        match find(&query, &Tabletop::new().world(), None) {
            Ok(answer) => check_words(&query, &answer),
            Err(error) => prop_assert!(matches!(error, Error::EmptyQuery)),
        }
    }

    #[test]
    fn parser_accounts_for_each_word_of_any_phrase(
        words in prop::collection::vec(prop::sample::select(&WORDS[..]), 1..40)
    ) {
        let query = words.join(" ");
        match find(&query, &Tabletop::new().world(), None) {
            Ok(answer) => check_words(&query, &answer),
            Err(error) => {
                let is_long = matches!(error, Error::LongQuery { .. });
                prop_assert!(is_long && query.len() > QUERY_CHARACTERS_MAX);
            }
        }
    }

    #[test]
    fn parser_doubts_each_match_of_a_query_with_unknown_words(
        words in prop::collection::vec(prop::sample::select(&WORDS[..]), 1..12)
    ) {
        let answer = ask(&words.join(" "));
        for found in &answer.matches {
            prop_assert!(answer.not_understood.is_empty() || !found.doubts.is_empty());
            prop_assert!((0.0..=1.0).contains(&found.score));
        }
    }
}

#[test]
fn parser_refuses_long_and_empty_queries() {
    let tabletop = Tabletop::new();
    let long = "mug ".repeat(101);
    let error = find(&long, &tabletop.world(), None).unwrap_err();
    assert!(matches!(
        error,
        Error::LongQuery {
            n_characters: 404,
            ..
        }
    ));
    assert!(matches!(
        find(" ?!", &tabletop.world(), None),
        Err(Error::EmptyQuery)
    ));
}

#[test]
fn parser_limits_the_depth_of_landmarks() {
    for part in [
        "left of the mug ",
        "between ",
        "not ",
        "near ",
        "except the ",
        "on a ",
    ] {
        let n_repeats = QUERY_CHARACTERS_MAX / part.len();
        let query = part.repeat(n_repeats);
        check_words(&query, &ask(&query));
    }
}

#[test]
fn grounding_accepts_any_float() {
    let mut tabletop = Tabletop::new();
    for object in &mut tabletop.objects[..4] {
        object.centre_in_world_m = [f64::NAN; 3];
        object.size_m = [f64::INFINITY; 3];
        object.orientation_xyzw = [f64::NAN; 4];
        object.color_shares = [f32::NAN; 11];
        object.names[0].1 = f64::NAN;
        object.first_seen_ns = i64::MIN;
        object.last_seen_ns = i64::MAX;
    }
    for query in [
        "the biggest red mug left of the box",
        "the nearest thing seen yesterday",
    ] {
        let answer = find(query, &tabletop.world(), None).unwrap();
        assert!(answer.matches.iter().all(|found| found.score.is_finite()));
    }
}

#[test]
fn grounding_in_an_empty_world_finds_nothing() {
    let tabletop = Tabletop::new();
    let world = QueryWorld {
        objects: &[],
        ..tabletop.world()
    };
    let answer = find("the biggest mug left of the box", &world, None).unwrap();
    assert!(answer.matches.is_empty());
}
