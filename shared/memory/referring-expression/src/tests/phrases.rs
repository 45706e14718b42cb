//! Phrases with the objects that they refer to.

use super::*;

#[track_caller]
fn check(table: &[(&str, &[u64])]) {
    let mut failures = Vec::new();
    for (query, expected) in table {
        let answer = ask(query);
        if ids(&answer) != *expected {
            failures.push(format!(
                "{query}: {:?}, not {expected:?}; {}",
                ids(&answer),
                answer.sentence
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn grounding_of_nouns() {
    check(&[
        ("the bottle", &[5]),
        ("Please, can you find the bottle?", &[5]),
        ("where is the bowl", &[8]),
        ("show me the box", &[3]),
        ("bring me a bottle", &[5]),
        ("I want the sponge", &[7]),
        ("pick up the apple please", &[10]),
        ("look for the Cereal Box", &[6]),
        ("the cereal-box", &[6]),
        ("tin can", &[9]),
        ("the can", &[9]),
        ("mugs", &[1, 2, 4]),
        ("all mugs", &[1, 2, 4]),
        ("every mug", &[1, 2, 4]),
        ("all boxes", &[3, 6]),
        ("the fork", &[]),
        ("the orange", &[11]),
        ("the orange orange", &[11]),
        ("the orange thing", &[11]),
        ("two mugs", &[1, 2]),
        ("everything", &[1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]),
        ("the bottle and the bowl", &[5, 8]),
        ("the fork or the bowl", &[8]),
        ("the pop tarts", &[]),
        ("the flurble", &[]),
        ("cups", &[1, 2, 4]),
        ("the cup with the red handle", &[1]),
    ]);
}

#[test]
fn grounding_of_colors() {
    check(&[
        ("the red mug", &[1]),
        ("the blue mug", &[2]),
        ("a crimson mug", &[1]),
        ("the navy mug", &[2]),
        ("red things", &[1, 9, 10]),
        ("the dark red mug", &[1]),
        ("the reddish mug", &[1]),
        ("the teal bottle", &[5]),
        ("the red and white thing", &[9]),
        ("all red or blue mugs", &[1, 2]),
        ("the mugs that are not red", &[2, 4]),
        ("non-red mugs", &[2, 4]),
        ("the green mug", &[]),
        ("the gray mug", &[]),
        ("the white coloured bowl", &[8]),
        ("the mug that is white", &[4]),
        ("the yellow ones", &[6, 7]),
        ("red mug and not blue", &[1]),
    ]);
}

#[test]
fn grounding_of_sizes() {
    check(&[
        ("the small mug", &[4]),
        ("the big mugs", &[1, 2]),
        ("the smallest mug", &[4]),
        ("the tallest object", &[6]),
        ("the biggest thing", &[6]),
        ("the second tallest thing", &[5]),
        ("all objects taller than the box", &[5, 6, 9]),
        ("the things bigger than the bowl", &[3, 6]),
        ("the flat thing", &[7]),
        ("the flattest object", &[7]),
        ("something about 25 cm tall", &[5]),
        ("all objects smaller than 8 cm", &[4, 10, 11]),
        ("the thing more than 28cm high", &[6]),
        ("the large bottle", &[5]),
        ("the smaller mug", &[4]),
    ]);
}

#[test]
fn grounding_of_relations() {
    check(&[
        ("the mug left of the box", &[1]),
        ("the mug to the right of the box", &[2]),
        ("all mugs right of the box", &[2, 4]),
        ("the thing behind the blue mug", &[6]),
        ("the bottle behind the red mug", &[5]),
        ("the mug in front of the bottle", &[1]),
        ("the apple on the box", &[10]),
        ("what is on top of the box", &[10]),
        ("the thing in the bowl", &[11]),
        ("the orange inside the bowl", &[11]),
        ("the box under the apple", &[3]),
        ("the box below the apple", &[3]),
        ("the object between the red mug and the blue mug", &[3, 10]),
        ("the box between the mugs", &[3]),
        ("the can next to the cereal box", &[9]),
        ("the mug near the cereal box", &[]),
        ("the mug left of the fork", &[]),
        ("the mug left of the box behind the sponge", &[1]),
        ("the thing behind the mug left of the box", &[5]),
        ("the mug that is blue and right of the box", &[2]),
        ("all mugs on the table", &[1, 2, 4]),
        ("the mug on the left", &[1]),
        ("the thing at the back on the left", &[5]),
        ("the mug on the right side of the table", &[2, 4]),
        ("mugs not left of the box", &[2, 4]),
        ("the mug not next to the box", &[4]),
        ("all mugs except the red mug", &[2, 4]),
        ("the mugs other than the white one", &[1, 2]),
        ("the leftmost mug", &[1]),
        ("the rightmost mug", &[4]),
        ("the second mug from the left", &[2]),
        ("the third mug from the left", &[4]),
        ("second from the left mug", &[2]),
        ("the nearest mug", &[4]),
        ("the mug closest to the sponge", &[1]),
        ("the object nearest to the tin can", &[6]),
        ("the farthest mug", &[1, 2]),
        ("the fifth mug from the left", &[]),
    ]);
}

#[test]
fn grounding_of_labels_and_times() {
    check(&[
        ("the unlabelled object", &[7]),
        ("the unknown thing", &[7]),
        ("the object without a label", &[7]),
        ("all labelled mugs", &[1, 2, 4]),
        ("the red thing that is out of view", &[9]),
        ("the one Anna taught you yesterday", &[1]),
        ("the thing that Anna showed you this morning", &[8]),
        ("what Anna taught you", &[8]),
        ("the mug Anna taught you", &[1]),
        ("the one I showed you two minutes ago", &[3]),
        ("the thing I taught you just now", &[3]),
        ("the thing I showed you two hours ago", &[5]),
        ("what I showed you 2 days ago", &[6]),
        ("the one I taught you on Monday", &[6]),
        ("the one I taught you last week", &[]),
        ("what Clara showed you", &[]),
        ("the object taught by Anna yesterday", &[1]),
        ("the newest object", &[11]),
        ("the object that appeared last", &[11]),
        ("the oldest mug", &[1]),
        ("the latest mug", &[4]),
    ]);
}

#[test]
fn grounding_states_doubts() {
    for (query, doubt) in [
        ("the red tin can", "track 9 is only 38 % red"),
        (
            "the red tin can",
            "track 9 is not in view; it was last seen 35 s ago",
        ),
        (
            "the sponge",
            "the label sponge of track 7 is only 61 % sure",
        ),
        ("the can", "`can` was taken as tin-can"),
        ("the red cup", "`cup` was taken as a synonym of mug"),
        ("the mug", "3 objects fit: tracks 1, 2 and 4"),
        ("the shiny bottle", "the word `shiny` was not understood"),
        ("the dark red mug", "the modifier `dark` was not used"),
        ("my bottle", "`my` was not used"),
        (
            "the bottle behind the mug",
            "3 objects fit `the mug`; track 1 was taken",
        ),
        ("the teal bottle", "`teal` was taken as green or blue"),
        ("what I showed you 2 days ago", "may be another object"),
        ("four mugs", "only 3 of 4 objects fit"),
        ("the second mug", "`second` was counted from the left"),
    ] {
        let answer = ask(query);
        assert!(
            doubts(&answer).contains(doubt),
            "{query}: {}",
            answer.sentence
        );
        assert!(
            answer.sentence.contains(doubt),
            "{query}: {}",
            answer.sentence
        );
    }
    for query in [
        "the bottle",
        "the red mug",
        "the mug left of the box",
        "the leftmost mug",
    ] {
        assert_eq!(doubts(&ask(query)), "", "{query}");
    }
}

#[test]
fn grounding_says_what_to_say_instead_of_words_that_are_not_understood() {
    let answer = ask("the red flurble in front of the bottle");
    assert!(answer.matches.is_empty());
    assert!(
        answer.sentence.contains(
            "the word `flurble` was not understood. Say a name that was taught, such as `apple`, \
             `bottle` or `bowl`, or a colour, a size or a place of the object."
        ),
        "{}",
        answer.sentence
    );
}

#[test]
fn grounding_names_the_closest_object() {
    assert_eq!(
        ask("the green mug").sentence,
        "Nothing here fits `the green mug`; track 4 is a mug, but is white."
    );
    assert!(
        ask("the fork")
            .sentence
            .starts_with("Nothing here fits `the fork`")
    );
    assert!(
        ask("the mug left of the fork")
            .sentence
            .contains("nothing here fits `the fork`")
    );
}

#[test]
fn grounding_without_a_viewpoint_says_so() {
    let tabletop = Tabletop::new();
    let world = QueryWorld {
        viewpoint: None,
        ..tabletop.world()
    };
    let answer = find("the bottle left of the box", &world, None).unwrap();
    assert_eq!(ids(&answer), [5]);
    assert_eq!(answer.not_understood, ["left", "of"]);
    assert!(doubts(&answer).contains("the pose of the camera is not known"));
    let answer = find("the apple on the box", &world, None).unwrap();
    assert_eq!(doubts(&answer), "");
}

#[test]
fn grounding_without_a_speaker_says_so() {
    let tabletop = Tabletop::new();
    let world = QueryWorld {
        speaker: None,
        ..tabletop.world()
    };
    let answer = find("what I showed you yesterday", &world, None).unwrap();
    assert_eq!(ids(&answer), [1]);
    assert!(doubts(&answer).contains("who `I` is is not known"));
}

#[test]
fn grounding_says_that_one_is_wanted() {
    for (query, wants_one) in [
        ("the mug", true),
        ("a mug", true),
        ("mugs", false),
        ("all mugs", false),
        ("two mugs", false),
        ("one mug", true),
        ("the bottle and the box", false),
    ] {
        assert_eq!(ask(query).wants_one, wants_one, "{query}");
    }
    assert_eq!(ids(&ask("a mug")), [1]);
}

#[test]
fn grounding_uses_a_lexicon() {
    struct Fruit;
    impl crate::Lexicon for Fruit {
        fn kinship(&self, words: &str, name: &str) -> Option<crate::Kinship> {
            let is_fruit = matches!(name, "apple" | "orange");
            (words.starts_with("fruit") && is_fruit)
                .then_some(crate::Kinship::Broader { n_levels: 1 })
        }
        fn is_noun(&self, words: &str) -> bool {
            words == "dog"
        }
    }
    let tabletop = Tabletop::new();
    let answer = find("all fruits", &tabletop.world(), Some(&Fruit)).unwrap();
    assert_eq!(ids(&answer), [10, 11]);
    assert!(answer.remarks.is_empty());
    assert!(doubts(&answer).contains("`fruits` was taken as a kind to which apple belongs"));
    let answer = find("the red dog", &tabletop.world(), Some(&Fruit)).unwrap();
    assert!(answer.matches.is_empty() && answer.not_understood.is_empty());
    let answer = find("the fruit", &tabletop.world(), None).unwrap();
    assert!(answer.matches.is_empty());
    assert!(answer.sentence.contains("synonyms are off"));
}
