//! Extremes of place and size, and sides among the candidates of a noun.

use super::pantry::{ask_pantry, check};
use super::*;

#[test]
fn extreme_places_mean_one_object() {
    check(&[
        ("the thing on the far right", &[18]),
        ("the object at the extreme right", &[18]),
        ("the thing furthest to the right", &[18]),
        ("the far right bottle", &[12]),
        ("the bottle on the very left of the table", &[3]),
        ("the mug furthest back", &[6]),
        ("the furthest back mug", &[6]),
        ("the mug at the very back", &[6]),
        ("the backmost mug", &[6]),
        ("the mug at the very front", &[5]),
        ("the mug closest to the front", &[5]),
        ("the mug all the way on the left", &[6]),
        ("the second bottle from the back", &[3, 12]),
        ("the mug that is not on the far left", &[5]),
        ("the mug that is not leftmost", &[5]),
        ("the far left shoe", &[16]),
    ]);
    for phrase in ["the things on the far right", "the things at the very back"] {
        assert!(ids(&ask_pantry(phrase)).len() > 1, "{phrase}");
    }
}

#[test]
fn sides_compare_the_candidates_of_a_noun() {
    check(&[
        ("the mug at the front", &[5]),
        ("the mug at the back", &[6]),
        ("the bottle on the left", &[3]),
        ("the left bottle", &[3]),
        ("the bottle on the right side of the table", &[12]),
        ("the mug at the front of the table", &[]),
        ("the bottle at the back", &[3, 12]),
        ("a mug at the front", &[]),
    ]);
    assert!(doubts(&ask_pantry("the mug at the front")).contains("only in comparison"));
}

#[test]
fn comparatives_choose_by_the_measured_error() {
    for (lead_m, expected, doubt) in [
        (0.012, &[1_u64][..], ""),
        (0.004, &[1], "tracks 1 and 2 hardly differ there"),
        (0.001, &[1, 2], "equally `taller`"),
    ] {
        let mut tabletop = Tabletop::new();
        tabletop.objects[0].size_m[2] += lead_m;
        tabletop.objects[3].presence = Presence::Gone;
        let answer = find("the taller mug", &tabletop.world(), None).unwrap();
        assert_eq!(ids(&answer), expected, "{}", answer.sentence);
        let all = doubts(&answer);
        assert!(
            all.contains(doubt) && (doubt.is_empty() == all.is_empty()),
            "{all}"
        );
    }
    let mut tabletop = Tabletop::new();
    tabletop.objects[0].size_m = [0.1; 3];
    tabletop.objects[3].presence = Presence::Gone;
    for query in [
        "the bigger mug",
        "the bigger of the two mugs",
        "the larger of the mugs",
    ] {
        let answer = find(query, &tabletop.world(), None).unwrap();
        assert_eq!(ids(&answer), [1], "{query}: {}", answer.sentence);
        assert!(answer.not_understood.is_empty(), "{query}");
    }
}
