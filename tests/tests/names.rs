//! Names of categories: one normal form, nothing invisible, and no look-alike without a word.

use crate::daemon::{Daemon, Sandbox};
use crate::skeleton::{id, wait_for_all};
use learning::CategoryName;
use perceptual_memory::{Mutation, MutationId, PerceptualMemory, Requester, StoreChange};
use serde_json::Value;

const TABLE: [&str; 2] = ["--source", "synthetic:0"];
const COMPOSED: &str = "caf\u{e9}";
const DECOMPOSED: &str = "cafe\u{301}";

/// Names of the categories in a document.
fn categories(document: &Value) -> Vec<String> {
    let categories = document["categories"].as_array().unwrap().iter();
    let names = categories.filter_map(|category| category["category"].as_str());
    names.map(str::to_owned).collect()
}

/// Names of the categories of a daemon.
pub(crate) fn names(daemon: &Daemon<'_>) -> Vec<String> {
    categories(&daemon.ask(&["categories"]))
}

#[test]
fn name_has_one_form_and_nothing_invisible() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    let tracks: Vec<String> = objects.iter().map(id).collect();
    daemon.ask(&["teach", &tracks[0], COMPOSED]);
    let taught = daemon.ask(&["teach", &tracks[1], DECOMPOSED]);
    assert_eq!(taught["category"], COMPOSED);
    assert_eq!(names(&daemon), [COMPOSED]);
    for query in [format!("the {COMPOSED}"), format!("the {DECOMPOSED}")] {
        let found = daemon.ask(&["find", &query]);
        assert_eq!(found["not_understood"], Value::Array(Vec::new()), "{found}");
    }
    for hidden in ['\u{3164}', '\u{115f}', '\u{e0041}', '\u{fe0f}', '\u{200c}'] {
        let (code, sentence) = daemon.refused(&["teach", &tracks[2], &format!("mug{hidden}")]);
        assert_ne!(code, 0);
        let code_point = format!("U+{:04X}", u32::from(hidden));
        assert!(sentence.contains(&code_point), "{sentence}");
    }
    assert_eq!(names(&daemon), [COMPOSED]);
    daemon.stop();
}

#[test]
fn name_like_that_of_another_category_is_told() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    let tracks: Vec<String> = objects.iter().map(id).collect();
    daemon.ask(&["teach", &tracks[0], "bottle"]);
    daemon.ask(&["teach", &tracks[2], "jar"]);
    // The second letter of the last one is Cyrillic.
    for alike in ["Bottle", "b\u{43e}ttle"] {
        for request in [
            &["teach", &tracks[1], alike][..],
            &["correct", &tracks[1], alike],
            &["rename", "jar", alike],
        ] {
            let (code, sentence) = daemon.refused(request);
            assert_eq!(code, 4, "{sentence}");
            assert!(sentence.contains("beside bottle"), "{sentence}");
            assert!(sentence.contains("--new"), "{sentence}");
        }
    }
    let file = sandbox.home().join("memory.export");
    let file = file.to_str().unwrap();
    daemon.ask(&["memory", "export", file]);
    let import = ["memory", "import", file, "--rename", "jar=Bottle"];
    let (_, sentence) = daemon.refused(&import);
    assert!(sentence.contains("beside bottle"), "{sentence}");
    assert_eq!(names(&daemon), ["bottle", "jar"]);
    daemon.ask(&[&import[..], &["--new"]].concat());
    daemon.ask(&["teach", &tracks[1], "Bottle", "--new"]);
    assert_eq!(names(&daemon), ["Bottle", "bottle", "jar"]);
    daemon.stop();
}

/// Lesson as a version took it that knew no normal form.
fn teach_as_earlier_version(memory: &mut PerceptualMemory, track_id: u64, text: &str) {
    let category = CategoryName::stored(text).unwrap();
    let lesson = StoreChange::Teach { track_id, category };
    let taught = memory.apply(&Mutation {
        id: MutationId::random().unwrap(),
        author: "anna".to_owned(),
        requester: Requester::administrator(0),
        wall_ns: 1,
        change: StoreChange::AllowingAlike(Box::new(lesson)),
    });
    taught.unwrap();
}

#[test]
fn stored_twins_are_joined_by_the_repair() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    let tracks = [0, 1].map(|i| objects[i]["track_id"].as_u64().unwrap());
    daemon.stop();
    let folder = sandbox.home().join("perceptual-memory");
    let (mut memory, _) = PerceptualMemory::open(&folder, 1).unwrap();
    for (track, text) in tracks.into_iter().zip([COMPOSED, DECOMPOSED]) {
        teach_as_earlier_version(&mut memory, track, text);
    }
    memory.close().unwrap();

    let daemon = sandbox.start(&TABLE);
    let twins = names(&daemon);
    assert_eq!(twins, [DECOMPOSED, COMPOSED]);
    let repaired = daemon.ask(&["memory", "repair"]);
    let what = repaired["repaired"]["what"].as_str().unwrap();
    assert!(what.contains("1 name(s) of categories"), "{what}");
    assert_eq!(names(&daemon), [COMPOSED]);
    let entry = what.rsplit(' ').next().unwrap();
    daemon.ask(&["undo", entry]);
    assert_eq!(names(&daemon), twins);
    daemon.ask(&["memory", "repair"]);
    assert_eq!(names(&daemon), [COMPOSED]);
    let again = daemon.ask(&["memory", "repair"]);
    let what = again["repaired"]["what"].as_str().unwrap();
    assert!(what.ends_with("nothing was changed"), "{what}");
    daemon.stop();
}
