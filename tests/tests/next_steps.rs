//! Next steps in refusals: candidates, swapped arguments, nearest names, what a daemon lacks.

use crate::daemon::{Daemon, Sandbox};
use crate::documents::store_model;
use crate::skeleton::{id, wait_for_all};

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];

/// Exit codes of wrong usage, a daemon that is not there, and a refusal.
const USAGE: i32 = 2;
const NO_DAEMON: i32 = 3;
const REFUSED: i32 = 4;

#[test]
fn track_is_named_by_words_that_mean_exactly_one_object() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let tracks: Vec<String> = wait_for_all(&daemon, 0).iter().map(id).collect();
    let [first, second, third] = &tracks[..3] else {
        panic!("{tracks:?}")
    };
    daemon.ask(&["teach", first, "mug"]);
    assert_eq!(daemon.ask(&["ask", "mug"])["track_id"].to_string(), *first);
    let found = daemon.ask(&["ask", "the mug"]);
    assert_eq!(found["track_id"].to_string(), *first);
    daemon.ask(&["correct", "mug", "tea cup"]);
    assert_eq!(daemon.ask(&["ask", first])["label"], "tea cup");
    daemon.ask(&["teach", "Tea Cup", "tea cup"]);
    check_recalled(&daemon, "tea cup", first);

    let refused = |arguments: &[&str], code: i32, parts: &[&str]| {
        let (found, sentence) = daemon.refused(arguments);
        assert_eq!(found, code, "{arguments:?}: {sentence}");
        for part in parts {
            assert!(sentence.contains(part), "{arguments:?}: {part}: {sentence}");
        }
    };
    let candidate = format!("track {first} (tea cup)");
    let all = [candidate.as_str(), "give the track-id"];
    for command in [
        &["ask", "teapot"][..],
        &["teach", "teapot", "pot"],
        &["correct", "teapot", "pot"],
        &["forget", "--track", "teapot"],
        &["memory", "inspect", "--track", "teapot"],
        &["world", "history", "--track", "teapot"],
        &["model", "build", "teapot"],
    ] {
        refused(command, REFUSED, &all);
    }
    for track in [second, third] {
        daemon.ask(&["correct", track, "box"]);
    }
    let both = [
        format!("track {second} (box)"),
        format!("track {third} (box)"),
    ];
    refused(
        &["correct", "box", "crate"],
        REFUSED,
        &both.each_ref().map(String::as_str),
    );
    daemon.ask(&["forget", "--track", "tea cup"]);
    daemon.stop();

    let output = sandbox.tabula(&["memory", "inspect", "--track", "box"]);
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(NO_DAEMON), "{sentence}");
    assert!(sentence.contains("give a track-id"), "{sentence}");
    let output = sandbox.tabula(&["memory", "inspect", "--track", second]);
    assert!(output.status.success(), "{output:?}");
}

/// Checks that the views and facts of an object that is named by words are those of a track.
fn check_recalled(daemon: &Daemon<'_>, words: &str, track: &str) {
    let views = daemon.ask(&["memory", "inspect", "--track", words]);
    let views = views["views"].as_array().unwrap();
    assert!(!views.is_empty());
    for view in views {
        assert_eq!(view["id"]["track_id"].to_string(), track, "{view}");
    }
    let facts = daemon.ask(&["world", "history", "--track", words]);
    for fact in facts["facts"].as_array().unwrap() {
        assert_eq!(fact["track_id"].to_string(), track, "{fact}");
    }
}

#[test]
fn swapped_arguments_and_a_track_in_place_of_a_category_are_told() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let tracks: Vec<String> = wait_for_all(&daemon, 0).iter().map(id).collect();
    let (first, second) = (&tracks[0], &tracks[1]);
    let refused = |arguments: &[&str], code: i32, part: &str| {
        let (found, sentence) = daemon.refused(arguments);
        assert_eq!(found, code, "{arguments:?}: {sentence}");
        assert!(sentence.contains(part), "{arguments:?}: {part}: {sentence}");
    };
    for verb in ["teach", "correct"] {
        let meant = format!("did you mean `tabula {verb} {first} can`?");
        refused(&[verb, "can", first], USAGE, &meant);
        let meant = format!("did you mean `tabula {verb} {first} 'red mug'`?");
        refused(&[verb, "red mug", first], USAGE, &meant);
    }
    let hint = format!("tabula forget --track {first} forgets the track {first}");
    refused(&["forget", first], REFUSED, &hint);
    refused(&["rename", first, "cup"], REFUSED, &hint);

    // A number may be a category, and a track-id wins in the place of the object.
    daemon.ask(&["teach", first, second]);
    assert_eq!(daemon.ask(&["ask", first])["label"], second.as_str());
    assert_eq!(
        daemon.ask(&["ask", second])["track_id"].to_string(),
        *second
    );
    daemon.ask(&["correct", first, "can"]);
    refused(&["rename", "cann", "cup"], REFUSED, "can may be meant");
    refused(&["merge", "can", "cann"], REFUSED, "can may be meant");
    daemon.ask(&["teach", second, first]);
    let taught = daemon.ask(&["correct", "can", first]);
    assert_eq!(taught["category"], first.as_str());
    refused(
        &["correct", "can", first],
        REFUSED,
        "; or did you mean `tabula correct",
    );
    daemon.ask(&["forget", first]);
    daemon.stop();
}

#[test]
fn missing_model_or_document_is_told_with_the_names_of_its_kind() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let refused = |arguments: &[&str], expected: &str| {
        let (code, sentence) = daemon.refused(arguments);
        assert_eq!(code, REFUSED, "{sentence}");
        assert!(sentence.contains(expected), "{arguments:?}: {sentence}");
    };
    refused(
        &["model", "show", "mug"],
        "store one with: tabula model build",
    );
    store_model(&sandbox, "teapot");
    daemon.ask(&["knowledge", "put", "teapots", "/etc/hostname"]);
    for verb in ["show", "export", "forget"] {
        let expected = "there is no model \"teapt\"; \"teapot\" may be meant; the models are \
                        \"teapot\"; see `tabula model list`";
        refused(&["model", verb, "teapt"], expected);
    }
    for verb in ["get", "remove"] {
        let expected = "the documents are \"teapots\"; see `tabula knowledge list`";
        refused(&["knowledge", verb, "teapot"], expected);
    }
    daemon.stop();
}

#[test]
fn command_for_the_arm_beside_a_camera_is_told_that_there_is_none() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    daemon.pids();
    for words in [
        ["arm", "state"],
        ["arm", "home"],
        ["arm", "stop"],
        ["task", "state"],
    ] {
        let (code, sentence) = daemon.refused(&words);
        assert_eq!(code, NO_DAEMON, "{sentence}");
        for part in ["this daemon has no arm", "tabula run --source simulation"] {
            assert!(sentence.contains(part), "{sentence}");
        }
        assert!(!sentence.contains("restarted"), "{sentence}");
    }
    daemon.stop();
}

#[test]
fn unknown_source_is_told_with_the_sources_that_there_are() {
    let sandbox = Sandbox::new();
    for (source, part) in [
        (
            "realsense",
            "nor a folder of this name; the sources are simulation[:SCENE], kinect, ",
        ),
        ("kinct", "; kinect may be meant; the sources are "),
        ("/nowhere", "there is no folder /nowhere; the sources are "),
    ] {
        let output = sandbox.tabula(&["run", "--source", source]);
        let sentence = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(USAGE), "{sentence}");
        assert!(sentence.contains(part), "{source}: {sentence}");
    }
}
