use super::*;
use scene_document::CategoryAnswer;

fn live(track_id: u64, label: Option<&str>) -> ObjectDocument {
    ObjectDocument {
        track_id,
        state: "tracked".to_owned(),
        label: label.map(str::to_owned),
        ..ObjectDocument::default()
    }
}

fn found(track_id: u64, state: &str, doubts: &[&str]) -> FoundObjectReport {
    FoundObjectReport {
        track_id,
        score: 0.9,
        doubts: doubts.iter().map(|&doubt| doubt.to_owned()).collect(),
        answer: CategoryAnswer::Is,
        label: Some("mug".to_owned()),
        state: state.to_owned(),
        position_m: None,
    }
}

fn report(matches: Vec<FoundObjectReport>) -> FindReport {
    FindReport {
        query: "the red mug".to_owned(),
        sentence: "Nothing here fits `the red mug`.".to_owned(),
        matches,
        wants_one: true,
        understood: Vec::new(),
        not_understood: Vec::new(),
        remarks: Vec::new(),
        scene_age_s: None,
        is_stale: false,
    }
}

#[test]
fn track_reference_of_digits_is_a_track_id() {
    let words = |text: &str| Ok(TrackReference::Words(text.to_owned()));
    for (text, expected) in [
        ("7", Ok(TrackReference::Id(7))),
        (" 007 ", Ok(TrackReference::Id(7))),
        ("the red mug", words("the red mug")),
        (" mug ", words("mug")),
        ("7up", words("7up")),
        ("-7", words("-7")),
        ("٧", words("٧")),
        ("", Err(InvalidTrackReference::Empty)),
        ("  ", Err(InvalidTrackReference::Empty)),
        ("99999999999999999999", Err(InvalidTrackReference::TooLarge)),
    ] {
        assert_eq!(text.parse(), expected, "{text:?}");
    }
}

#[test]
fn track_reference_by_label_needs_exactly_one_object_with_it() {
    let objects = [
        live(1, Some("mug")),
        live(2, Some("Bottle")),
        live(3, Some("bottle")),
        live(4, Some("box")),
        live(5, Some("box")),
        live(6, None),
    ];
    let track = |words| labelled(words, &objects);
    assert_eq!(track("mug"), Some(Ok(1)));
    assert_eq!(track("MUG"), Some(Ok(1)));
    assert_eq!(track("bottle"), Some(Ok(3)), "the case decides");
    assert_eq!(track("teapot"), None);
    assert_eq!(track("unknown"), None);
    for (words, candidates) in [
        ("BOTTLE", "track 2 (Bottle), track 3 (bottle)"),
        ("box", "track 4 (box), track 5 (box)"),
    ] {
        let sentence = track(words).unwrap().unwrap_err();
        assert!(sentence.contains(candidates), "{sentence}");
        assert!(sentence.contains("give the track-id"), "{sentence}");
    }
}

#[test]
fn track_reference_by_description_takes_a_single_match_within_its_scope() {
    let objects = [live(1, Some("mug")), live(2, None)];
    let track = |matches: Vec<FoundObjectReport>, scope| {
        let report = report(matches);
        let chosen = described("the red mug", &report, &objects, scope);
        chosen.map(|one| one.track_id)
    };
    let sure = || vec![found(1, "tracked", &[])];
    let doubtful = || vec![found(1, "tracked", &["only 30 % of it is red"])];
    let gone = || vec![found(9, "gone", &[])];
    for scope in [TrackScope::LOOK, TrackScope::CHANGE, TrackScope::FORGET] {
        assert_eq!(track(sure(), scope), Ok(1), "{scope:?}");
    }
    assert_eq!(track(doubtful(), TrackScope::LOOK), Ok(1));
    assert_eq!(track(gone(), TrackScope::RECALL), Ok(9));
    assert_eq!(track(gone(), TrackScope::FORGET), Ok(9));
    let several = vec![found(1, "tracked", &[]), found(2, "occluded", &[])];
    for (matches, scope, part) in [
        (doubtful(), TrackScope::CHANGE, "but only 30 % of it is red"),
        (doubtful(), TrackScope::CHANGE, "give its track-id, 1,"),
        (gone(), TrackScope::CHANGE, "which is gone"),
        (
            gone(),
            TrackScope::LOOK,
            "the objects are track 1 (mug), track 2 (unknown)",
        ),
        (
            several,
            TrackScope::RECALL,
            "track 1 (mug), track 2 (mug, occluded)",
        ),
        (
            vec![],
            TrackScope::RECALL,
            "Nothing here fits `the red mug`; the objects are",
        ),
    ] {
        let sentence = track(matches, scope).unwrap_err();
        assert!(sentence.contains(part), "{sentence}");
        assert!(sentence.contains("track-id"), "{sentence}");
    }
}

#[test]
fn track_reference_names_twelve_objects_at_most_and_knows_an_empty_table() {
    let many: Vec<_> = (1..=20).map(|track_id| live(track_id, None)).collect();
    let sentence = nothing(&report(vec![]), &many);
    assert!(
        sentence.contains("track 12 (unknown), 8 more"),
        "{sentence}"
    );
    let sentence = nothing(&report(vec![]), &[]);
    assert!(sentence.contains("nothing is tracked now"), "{sentence}");
}

#[test]
fn track_reference_means_a_definite_object() {
    for (words, expected) in [
        ("a mug", "the mug"),
        ("Any red mug", "the red mug"),
        ("mug", "mug"),
        ("the mug", "the mug"),
        ("anchor", "anchor"),
    ] {
        assert_eq!(definite(words), expected);
    }
}
