//! Names of categories: look-alikes are refused, and names of earlier versions are joined.

use learning::CategoryName;
use perceptual_memory::{
    Condition, Mutation, Operation, PerceptualMemory, StoreChange, StoreRefusal, Target,
};
use tempfile::TempDir;

use crate::builders::{
    apply, correct, counts, fast_folder, mutation, name, open, refusal, store, teach, undo, view,
};

const COMPOSED: &str = "caf\u{e9}";
const DECOMPOSED: &str = "cafe\u{301}";

/// Store with a view on each of five tracks: entries 1 to 5.
fn begun() -> (TempDir, PerceptualMemory) {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    for track in 1..=5 {
        apply(
            &mut memory,
            &[store(u128::from(track), vec![view(track, 0, 0)])],
        );
    }
    (folder, memory)
}

/// The mutation, with a name like that of another category.
fn allowing_alike(mutation: Mutation) -> Mutation {
    Mutation {
        change: StoreChange::AllowingAlike(Box::new(mutation.change)),
        ..mutation
    }
}

/// Lesson as an earlier version took it.
fn taught_earlier(id: u128, track_id: u64, text: &str) -> Mutation {
    let category = CategoryName::stored(text).unwrap();
    allowing_alike(mutation(id, StoreChange::Teach { track_id, category }))
}

fn names(memory: &PerceptualMemory) -> Vec<(String, u64)> {
    counts(memory)
}

fn named(text: &str, n_views: u64) -> (String, u64) {
    (text.to_owned(), n_views)
}

#[test]
fn name_like_that_of_another_category_is_refused() {
    let (_folder, mut memory) = begun();
    apply(&mut memory, &[teach(6, 1, "bottle"), teach(7, 2, "Straße")]);
    for (id, alike, existing, why) in [
        (
            8,
            "Bottle",
            "bottle",
            "differs only in upper and lower case",
        ),
        (
            9,
            "STRASSE",
            "Straße",
            "differs only in upper and lower case",
        ),
        // The second letter is Cyrillic.
        (10, "b\u{43e}ttle", "bottle", "looks like it"),
    ] {
        for request in [teach(id, 3, alike), correct(id, 3, alike)] {
            let refused = refusal(memory.apply(&request));
            let expected = StoreRefusal::NameAlike {
                name: name(alike),
                existing: name(existing),
            };
            assert_eq!(refused, expected);
            let sentence = refused.to_string();
            for part in [existing, why, "--new"] {
                assert!(sentence.contains(part), "{sentence}");
            }
        }
    }
    assert_eq!(memory.sequence(), 7, "nothing was changed");
    // It is made on request, and is a category like any other from then on.
    apply(
        &mut memory,
        &[
            allowing_alike(teach(11, 3, "Bottle")),
            teach(12, 4, "Bottle"),
        ],
    );
    let expected = [named("Bottle", 2), named("Straße", 1), named("bottle", 1)];
    assert_eq!(names(&memory), expected);
}

#[test]
fn category_that_goes_is_no_other_one() {
    let (_folder, mut memory) = begun();
    apply(&mut memory, &[teach(6, 1, "bottle")]);
    let rename = |id, from: &str, to: &str| {
        let (from, to) = (name(from), name(to));
        mutation(id, StoreChange::Rename { from, to })
    };
    apply(
        &mut memory,
        &[rename(7, "bottle", "Bottle"), correct(8, 1, "bottle")],
    );
    assert_eq!(names(&memory), [named("bottle", 1)]);
    apply(&mut memory, &[teach(9, 2, "jar")]);
    let refused = refusal(memory.apply(&rename(10, "jar", "BOTTLE")));
    assert!(
        matches!(refused, StoreRefusal::NameAlike { .. }),
        "{refused}"
    );
    // An undo restores what was, whatever it looks like.
    apply(
        &mut memory,
        &[
            rename(11, "bottle", "cup"),
            rename(12, "jar", "Bottle"),
            undo(13, 10),
        ],
    );
    assert_eq!(names(&memory), [named("Bottle", 1), named("bottle", 1)]);
}

#[test]
fn names_of_earlier_versions_are_joined_and_the_joining_is_undone() {
    let (folder, mut memory) = begun();
    apply(
        &mut memory,
        &[
            taught_earlier(6, 1, COMPOSED),
            taught_earlier(7, 2, DECOMPOSED),
            taught_earlier(8, 3, "mug\u{3164}"),
            taught_earlier(9, 4, "mug\u{e0041}"),
            taught_earlier(10, 5, "jar"),
        ],
    );
    drop(memory);
    let (mut memory, report) = open(&folder);
    assert_eq!(report.condition, Condition::Sound, "{report}");
    let before = names(&memory);
    assert_eq!(before.len(), 5);
    assert_eq!(memory.n_names_to_normalise(), 3);
    apply(&mut memory, &[mutation(11, StoreChange::NormaliseNames)]);
    let joined = [named(COMPOSED, 2), named("jar", 1), named("mug", 2)];
    assert_eq!(names(&memory), joined);
    assert_eq!(memory.n_names_to_normalise(), 0);
    let entry = memory.history(11, 1).unwrap().remove(0);
    assert!(matches!(entry.operation, Operation::NormaliseNames { names } if names.len() == 3));
    apply(&mut memory, &[undo(12, 11)]);
    assert_eq!(names(&memory), before);
    apply(&mut memory, &[mutation(13, StoreChange::Redo)]);
    assert_eq!(names(&memory), joined);
    let found = memory.checkpoint().unwrap().open().unwrap();
    assert_eq!(found.verify(|_| {}).unwrap().findings, [""; 0]);
}

/// A category of an earlier version is found by the name as people write it today.
#[test]
fn name_of_an_earlier_version_is_found_by_that_of_today() {
    let (_folder, mut memory) = begun();
    apply(
        &mut memory,
        &[taught_earlier(6, 1, DECOMPOSED), teach(7, 2, COMPOSED)],
    );
    assert_eq!(names(&memory), [named(DECOMPOSED, 2)]);
    let target = Target::Category(name(COMPOSED));
    assert_eq!(memory.views(Some(&target), None, 9).unwrap().len(), 2);
    let (from, to) = (name(COMPOSED), name("mug"));
    apply(
        &mut memory,
        &[mutation(8, StoreChange::Rename { from, to })],
    );
    assert_eq!(names(&memory), [named("mug", 2)]);
}

#[test]
fn imported_names_are_compared_with_each_other_and_with_those_stored() {
    let (_folder, mut memory) = begun();
    apply(&mut memory, &[teach(6, 1, "bottle")]);
    let check = |names: &[&str]| {
        let names = names.iter().map(|text| name(text)).collect();
        memory.check_new_names(&names)
    };
    check(&["bottle", "jar", "cup"]).unwrap();
    for alike in [&["Bottle"][..], &["cup", "Cup"]] {
        let refused = refusal(check(alike));
        assert!(
            matches!(refused, StoreRefusal::NameAlike { .. }),
            "{refused}"
        );
    }
}
