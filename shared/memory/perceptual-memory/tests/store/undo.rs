//! Undo and redo: the lists of a user, obstacles, imports, and histories of earlier versions.

use perceptual_memory::{
    ForeignView, ImportPart, Mutation, Operation, PerceptualMemory, Requester, StoreChange,
    StoreRefusal,
};
use tempfile::TempDir;

use crate::archiving;
use crate::builders::{
    answer, apply, correct, counts, fast_folder, forget, mutation, name, open, refusal, store,
    teach, undo, view,
};

/// Mutation by a teacher of this user id.
fn by(author: &str, uid: u32, mutation: Mutation) -> Mutation {
    Mutation {
        author: author.to_owned(),
        requester: Requester {
            uid: Some(uid),
            may_undo_others: false,
        },
        ..mutation
    }
}

fn last_undo(id: u128) -> Mutation {
    mutation(id, StoreChange::Undo { sequence: None })
}

fn redo(id: u128) -> Mutation {
    mutation(id, StoreChange::Redo)
}

fn rename(id: u128, from: &str, to: &str) -> Mutation {
    let (from, to) = (name(from), name(to));
    mutation(id, StoreChange::Rename { from, to })
}

/// Store with a view on each of three tracks: entries 1 to 3.
fn begun() -> (TempDir, PerceptualMemory) {
    let folder = fast_folder();
    let (mut memory, _) = open(&folder);
    for track in 1..=3 {
        let stored = store(u128::from(track), vec![view(track, 0, 0)]);
        apply(&mut memory, &[by("perception", 990, stored)]);
    }
    (folder, memory)
}

fn named(memory: &PerceptualMemory) -> Vec<String> {
    counts(memory).into_iter().map(|(name, _)| name).collect()
}

#[test]
fn undo_goes_on_to_the_change_before() {
    let (folder, mut memory) = begun();
    apply(&mut memory, &[teach(4, 1, "a"), rename(5, "a", "b")]);
    apply(&mut memory, &[last_undo(6)]);
    assert_eq!(named(&memory), ["a"]);
    apply(&mut memory, &[last_undo(7)]);
    assert_eq!(named(&memory), [""; 0]);
    let nothing = refusal(memory.apply(&last_undo(8)));
    assert_eq!(nothing, StoreRefusal::NothingToUndo);
    drop(memory);
    let (mut memory, _) = open(&folder);
    apply(&mut memory, &[redo(9)]);
    assert_eq!(named(&memory), ["a"]);
    apply(&mut memory, &[redo(10)]);
    assert_eq!(named(&memory), ["b"]);
    let nothing = refusal(memory.apply(&redo(11)));
    assert_eq!(nothing, StoreRefusal::NothingToRedo);
    let history = memory.history(6, 9).unwrap();
    let operations: Vec<_> = history
        .iter()
        .map(|entry| entry.operation.clone())
        .collect();
    let undo = |sequence, redone| Operation::Undo { sequence, redone };
    let expected = [
        undo(5, None),
        undo(4, None),
        undo(7, Some(4)),
        undo(6, Some(5)),
    ];
    assert_eq!(operations, expected);
}

/// The older lesson was taken back silently instead of the one before the renaming.
#[test]
fn undo_does_not_skip_to_an_unrelated_change() {
    let (_folder, mut memory) = begun();
    apply(
        &mut memory,
        &[teach(4, 2, "older"), teach(5, 1, "a"), rename(6, "a", "b")],
    );
    apply(&mut memory, &[last_undo(7), last_undo(8)]);
    assert_eq!(named(&memory), ["older"]);
}

#[test]
fn undone_undo_is_no_obstacle() {
    let (_folder, mut memory) = begun();
    apply(
        &mut memory,
        &[teach(4, 1, "a"), rename(5, "a", "b"), last_undo(6)],
    );
    assert_eq!(apply(&mut memory, &[undo(7, 4)]), [answer(7, 1)]);
    assert_eq!(named(&memory), [""; 0]);
    // By its number an undo is taken back, too.
    apply(&mut memory, &[undo(8, 7)]);
    assert_eq!(named(&memory), ["a"]);
    let taken_back = refusal(memory.apply(&undo(9, 7)));
    let expected = StoreRefusal::UndoneAlready { sequence: 7, by: 8 };
    assert_eq!(taken_back, expected);
    assert!(
        taken_back.to_string().contains("entry 8 undid it"),
        "{taken_back}"
    );
}

#[test]
fn new_change_ends_the_redo_list() {
    let (_folder, mut memory) = begun();
    apply(
        &mut memory,
        &[teach(4, 1, "a"), last_undo(5), teach(6, 2, "b")],
    );
    let nothing = refusal(memory.apply(&redo(7)));
    assert_eq!(nothing, StoreRefusal::NothingToRedo);
    // A request that changed nothing is no change.
    apply(
        &mut memory,
        &[last_undo(8), teach(9, 1, "c"), last_undo(10)],
    );
    apply(
        &mut memory,
        &[
            correct(11, 3, "d"),
            correct(12, 3, "d"),
            last_undo(13),
            redo(14),
        ],
    );
    assert_eq!(named(&memory), ["d"]);
}

#[test]
fn change_of_others_is_named_and_never_skipped() {
    let (_folder, mut memory) = begun();
    let anna = |mutation| by("anna", 1000, mutation);
    let ben = |mutation| by("ben", 1001, mutation);
    apply(
        &mut memory,
        &[anna(teach(4, 2, "older")), anna(teach(5, 1, "a"))],
    );
    apply(&mut memory, &[ben(correct(6, 1, "b"))]);
    for id in [7, 8] {
        let refused = refusal(memory.apply(&anna(last_undo(id))));
        assert!(
            matches!(
                refused,
                StoreRefusal::ChangedSince {
                    sequence: 5,
                    by: 6,
                    ..
                }
            ),
            "{refused:?}"
        );
        let expected = "entry 5 cannot be undone, since entry 6 by ben changed view 0 of track 1 \
                        after it; undo that one first, or name another entry";
        assert_eq!(refused.to_string(), expected);
    }
    apply(
        &mut memory,
        &[ben(last_undo(9)), anna(last_undo(10)), anna(last_undo(11))],
    );
    assert_eq!(named(&memory), [""; 0]);
    // The redo of ben's correction would rest on a lesson that is undone.
    let refused = refusal(memory.apply(&ben(redo(12))));
    let expected = "entry 6 cannot be redone, since entry 8 by anna changed view 0 of track 1";
    assert!(refused.to_string().starts_with(expected), "{refused}");
    apply(
        &mut memory,
        &[anna(redo(13)), anna(redo(14)), ben(redo(15))],
    );
    assert_eq!(named(&memory), ["b", "older"]);
}

#[test]
fn undo_of_others_needs_the_right_to() {
    let (_folder, mut memory) = begun();
    let ben = |mutation| by("ben", 1001, mutation);
    apply(
        &mut memory,
        &[by("anna", 1000, teach(4, 1, "a")), ben(teach(5, 2, "b"))],
    );
    // A claimed name gives no right.
    let forged = by("anna", 1001, last_undo(6));
    assert_eq!(refusal(memory.apply(&forged)), StoreRefusal::NothingToUndo);
    apply(&mut memory, &[by("anna", 1000, last_undo(7))]);
    let forged = by("anna", 1001, redo(8));
    assert_eq!(refusal(memory.apply(&forged)), StoreRefusal::NothingToRedo);
    let refused = refusal(memory.apply(&ben(undo(9, 6))));
    assert!(
        matches!(refused, StoreRefusal::OthersEntry { .. }),
        "{refused:?}"
    );
    // What an administrator redoes is in the list of its user again.
    apply(&mut memory, &[undo(10, 6), by("anna", 1000, last_undo(11))]);
    assert_eq!(named(&memory), ["b"]);
}

/// Views that another robot taught, in an export.
fn foreign_views() -> Vec<ForeignView> {
    let (_folder, mut other) = begun();
    apply(&mut other, &[teach(4, 1, "x"), teach(5, 2, "y")]);
    let mut views = Vec::new();
    let mut reader = other.checkpoint().unwrap().open().unwrap();
    let take = |view| -> Result<(), perceptual_memory::Error> {
        views.push(view);
        Ok(())
    };
    reader.export(take, |_| Ok(())).unwrap();
    views
}

#[test]
fn import_in_parts_is_undone_and_redone_as_one() {
    let (folder, mut memory) = begun();
    let views = foreign_views();
    let part = |id, views: &[ForeignView], first, is_continued| {
        let change = StoreChange::Import {
            source: "another robot".to_owned(),
            views: views.to_vec(),
            documents: Vec::new(),
            part: ImportPart {
                first,
                is_continued,
            },
        };
        mutation(id, change)
    };
    apply(
        &mut memory,
        &[teach(4, 1, "a"), part(5, &views[..1], None, true)],
    );
    // Another user's change between the parts belongs to nobody's import.
    apply(&mut memory, &[by("ben", 1001, teach(6, 2, "b"))]);
    apply(&mut memory, &[part(7, &views[1..], Some(5), false)]);
    let all = ["a", "b", "x", "y"];
    assert_eq!(named(&memory), all);
    for (id, sequence) in [(10, None), (20, Some(5)), (30, Some(7))] {
        memory
            .apply(&mutation(id, StoreChange::Undo { sequence }))
            .unwrap();
        assert_eq!(named(&memory), ["a", "b"], "{sequence:?}");
        apply(&mut memory, &[redo(id + 1)]);
        assert_eq!(named(&memory), all);
    }
    memory.set_limits(archiving::limits());
    archiving::archive(&mut memory);
    drop(memory);
    let (mut memory, _) = open(&folder);
    apply(&mut memory, &[last_undo(40), last_undo(41)]);
    assert_eq!(named(&memory), ["b"]);
}

/// The list goes through archived entries, and undoes those.
#[test]
fn undo_goes_on_in_the_archive() {
    let (folder, mut memory) = begun();
    memory.set_limits(archiving::limits());
    apply(&mut memory, &[teach(4, 1, "a"), rename(5, "a", "b")]);
    for id in 6..40 {
        let stored = store(id, vec![view(id as u64, 0, 0)]);
        apply(&mut memory, &[by("perception", 990, stored)]);
    }
    archiving::archive(&mut memory);
    drop(memory);
    let (mut memory, report) = open(&folder);
    assert!(!report.is_damage(), "{report}");
    apply(&mut memory, &[last_undo(50), last_undo(51)]);
    assert_eq!(named(&memory), [""; 0]);
    apply(
        &mut memory,
        &[redo(52), redo(53), forget(54, "b"), last_undo(55)],
    );
    assert_eq!(named(&memory), ["b"]);
}
