//! Reasons of empty answers, and colours of the only candidate.

use super::pantry::ask_pantry;
use super::*;

#[test]
fn empty_answers_say_why() {
    for (query, reason) in [
        ("the fork", "; no object here is named `fork`"),
        ("the brown mug", "is a mug, but is "),
        (
            "the purple thing",
            "; tracks 23 and 24, which are gone, may fit: their colour is not known",
        ),
        (
            "the red vase",
            "; track 23, which is gone, may fit: its colour is not known",
        ),
        (
            "the green teapot",
            "; track 21 is gone and is a teapot, but is blue",
        ),
    ] {
        let answer = ask_pantry(query);
        assert!(answer.matches.is_empty(), "{query}");
        assert!(
            answer.sentence.contains(reason),
            "{query}: {}",
            answer.sentence
        );
    }
    let answer = ask_pantry("the mug left of the lime and the fork");
    assert!(!answer.matches.is_empty());
}

#[test]
fn empty_answers_name_the_nearest_colour() {
    let mut tabletop = Tabletop::new();
    tabletop.objects[6].color_shares[BLUE] = 0.1;
    tabletop.objects[1].color_shares.swap(RED, BLUE);
    let answer = find("the blue thing", &tabletop.world(), None).unwrap();
    let text = "track 7 comes nearest, but is yellow";
    assert!(answer.sentence.contains(text), "{}", answer.sentence);
}

#[test]
fn colours_of_the_only_candidate_need_a_quarter() {
    for (share, n_found) in [(0.26, 1), (0.2, 0)] {
        let mut tabletop = Tabletop::new();
        tabletop.objects[8].color_shares[RED] = 0.0;
        tabletop.objects[8].color_shares[BLUE] = share;
        let answer = find("the blue can", &tabletop.world(), None).unwrap();
        assert_eq!(answer.matches.len(), n_found, "{}", answer.sentence);
        let percent = format!("is only {:.0} % blue", 100.0 * share);
        assert!(n_found == 0 || doubts(&answer).contains(&percent));
        assert!(answer.sentence.contains("track 9"), "{}", answer.sentence);
    }
}

#[test]
fn meanings_name_the_categories_that_are_here() {
    let answer = ask_pantry("the teapot next to the ball");
    let meaning = &answer.understood.last().unwrap().meaning;
    assert_eq!(meaning, "the category tennis-ball");
    let mut tabletop = Tabletop::new();
    tabletop.taught_names.push("bin-box".to_owned());
    let answer = find("all boxes", &tabletop.world(), None).unwrap();
    let meaning = &answer.understood.last().unwrap().meaning;
    assert_eq!(meaning, "the category box or cereal-box");
}
