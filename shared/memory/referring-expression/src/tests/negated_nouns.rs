//! Negated nouns, words that are accepted without a use, and openings of requests.

use super::*;

#[test]
fn negated_nouns_exclude_their_objects() {
    for (query, excluded) in [
        ("anything that is not a mug", &[1_u64, 2, 4][..]),
        ("things that are not mugs", &[1, 2, 4]),
        ("everything that isn't a bowl", &[8]),
        ("all objects which are not bottles", &[5]),
        ("everything that is not a mug or a bowl", &[1, 2, 4, 8]),
        ("the things that are neither mugs nor bowls", &[1, 2, 4, 8]),
        ("everything that is not a red mug", &[1]),
        ("everything but mugs", &[1, 2, 4]),
        ("everything that is not red", &[1, 10]),
    ] {
        let answer = ask(query);
        let mut expected: Vec<u64> = (1..=11).collect();
        expected.retain(|id| !excluded.contains(id));
        assert_eq!(ids(&answer), expected, "{query}: {}", answer.sentence);
        assert!(answer.not_understood.is_empty(), "{query}");
    }
    assert_eq!(ids(&ask("the mugs that are not a fork")), [1, 2, 4]);
}

#[test]
fn possessives_are_told_wherever_they_stand() {
    for query in [
        "my bottle",
        "where did I put my bottle?",
        "any of my bottles",
        "the bottle that my mother likes",
        "the bottle behind my mug",
    ] {
        let answer = ask(query);
        let all = doubts(&answer);
        assert!(
            all.contains("`my` was not used"),
            "{query}: {}",
            answer.sentence
        );
        assert!(!answer.not_understood.contains(&"my".to_owned()), "{query}");
    }
}

#[test]
fn requests_about_the_past_are_openings() {
    for query in [
        "where did you last see the bottle?",
        "where did I put the bottle?",
        "have you seen the bottle?",
        "where was the bottle?",
        "do you know where the bottle is",
        "can I have the bottle",
        "I can't find the bottle",
    ] {
        let answer = ask(query);
        assert_eq!(ids(&answer), [5], "{query}");
        assert!(
            answer.not_understood.is_empty(),
            "{query}: {:?}",
            answer.not_understood
        );
        assert_eq!(doubts(&answer), "", "{query}");
    }
}

#[test]
fn modifiers_of_relations_are_not_used() {
    for modifier in ["directly", "right", "immediately", "a bit"] {
        let answer = ask(&format!("the bottle {modifier} behind the red mug"));
        assert_eq!(ids(&answer), [5], "{modifier}");
        assert!(answer.not_understood.is_empty(), "{modifier}");
        assert!(doubts(&answer).contains(&format!("the modifier `{modifier}` was not used")));
    }
}

#[test]
fn verbs_of_other_clauses_are_not_corrected() {
    for (query, verb) in [
        ("the bottle that I brighted", "brighted"),
        ("the bottle that you blewe", "blewe"),
    ] {
        let answer = ask(query);
        assert!(
            answer.not_understood.contains(&verb.to_owned()),
            "{query}: {answer:?}"
        );
        assert!(
            !answer.sentence.contains("was read as"),
            "{}",
            answer.sentence
        );
    }
    assert_eq!(ids(&ask("the one that I shwoed you two hours ago")), [5]);
    assert_eq!(ids(&ask("can you fnid the bottle")), [5]);
}
