//! Undo and redo by `tabula`: through all kinds of changes, restarts, users and imports, with and
//! without a daemon.

use crate::daemon::Sandbox;
use crate::names::names;
use crate::skeleton::{id, wait_for_all};
use serde_json::Value;

const TABLE: [&str; 2] = ["--source", "synthetic:0"];

/// JSON document of `tabula` without a daemon.
fn offline(sandbox: &Sandbox, arguments: &[&str]) -> Value {
    let output = sandbox.tabula(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn undo_and_redo_walk_through_the_changes_of_a_user() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    let [first, second] = [id(&objects[0]), id(&objects[1])];
    daemon.ask(&["teach", &second, "older"]);
    let lesson = daemon.ask(&["teach", &first, "a"]);
    daemon.ask(&["rename", "a", "b"]);
    let undone = daemon.ask(&["undo"]);
    assert_eq!(undone["category"], "rename a to b", "{undone}");
    // The lesson, and neither nothing nor the older one.
    let undone = daemon.ask(&["undo"]);
    assert_eq!(undone["category"], format!("teach track {first} as a"));
    assert_eq!(names(&daemon), ["older"]);
    let redone = daemon.ask(&["redo"]);
    assert_eq!(redone["category"], format!("teach track {first} as a"));
    daemon.stop();

    // Without a daemon, and after it the same lists.
    assert_eq!(offline(&sandbox, &["redo"])["category"], "rename a to b");
    let history = offline(&sandbox, &["memory", "history"]);
    let last = history["entries"].as_array().unwrap().last().unwrap();
    let what = format!("redo entry {}", last["redone"]);
    assert_eq!(
        (&last["operation"], &last["what"]),
        (&"undo".into(), &what.into())
    );
    assert_eq!(offline(&sandbox, &["undo"])["category"], "rename a to b");
    let daemon = sandbox.start(&TABLE);
    daemon.ask(&["undo", &lesson["sequence"].to_string()]);
    assert_eq!(names(&daemon), ["older"]);
    daemon.ask(&["redo"]);
    daemon.ask(&["redo"]);
    assert_eq!(names(&daemon), ["b", "older"]);
    let (code, nothing) = daemon.refused(&["redo"]);
    assert_eq!(code, 4, "{nothing}");
    assert!(nothing.contains("nothing to redo"), "{nothing}");
    let text = sandbox.tabula(&["undo"]).stdout;
    let text = String::from_utf8(text).unwrap();
    assert!(
        text.starts_with("undid \"rename a to b\": 1 view(s)"),
        "{text}"
    );
    daemon.stop();
}

#[test]
fn undo_names_the_later_change_of_another_user() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let track = id(&wait_for_all(&daemon, 0)[0]);
    daemon.ask(&["teach", &track, "mug", "--author", "anna"]);
    let corrected = daemon.ask(&["correct", &track, "bowl", "--author", "ben"]);
    let (_, refused) = daemon.refused(&["undo", "--author", "anna"]);
    let by = format!("since entry {} by ben changed view", corrected["sequence"]);
    assert!(refused.contains(&by), "{refused}");
    daemon.ask(&["undo", "--author", "ben"]);
    daemon.ask(&["undo", "--author", "anna"]);
    assert_eq!(names(&daemon), [""; 0]);
    daemon.ask(&["redo", "--author", "anna"]);
    daemon.ask(&["redo", "--author", "ben"]);
    assert_eq!(names(&daemon), ["bowl"]);
    daemon.stop();
}

/// Learning a folder and importing a memory are single steps, however many views they bring.
#[test]
fn undo_takes_back_what_was_learned_at_once() {
    let sandbox = Sandbox::new();
    let folder = tempfile::tempdir().unwrap();
    let views = folder.path().join("views");
    let views = views.to_str().unwrap();
    let choice = ["--category", "bowl", "--category", "cereal-box"];
    let amount = ["--instances", "2", "--views", "6", "--out", views];
    let written = sandbox.tabula(&[&["simulate", "views"], &choice[..], &amount[..]].concat());
    assert!(written.status.success(), "{written:?}");
    let daemon = sandbox.start(&TABLE);
    let track = id(&wait_for_all(&daemon, 0)[0]);
    daemon.ask(&["teach", &track, "mug"]);
    let learned = daemon.ask(&["learn", views]);
    assert_eq!(names(&daemon), ["bowl", "cereal-box", "mug"]);
    let undone = daemon.ask(&["undo"]);
    assert_eq!(undone["n_views_changed"], learned["n_views"], "{undone}");
    assert_eq!(names(&daemon), ["mug"]);
    daemon.ask(&["undo"]);
    assert_eq!(names(&daemon), [""; 0]);
    daemon.ask(&["redo"]);
    daemon.ask(&["redo"]);
    assert_eq!(names(&daemon), ["bowl", "cereal-box", "mug"]);
    daemon.ask(&["undo", &learned["sequence"].to_string()]);
    assert_eq!(names(&daemon), ["mug"]);
    daemon.stop();
}
