//! Batch learning: a running daemon learns a folder of labelled views.

use crate::daemon::{Daemon, Sandbox};
use serde_json::Value;
use std::path::Path;

/// Writes views of two generated categories.
fn write_views(sandbox: &Sandbox, folder: &Path) {
    let folder = folder.to_str().unwrap();
    let choice = ["--category", "bowl", "--category", "cereal-box"];
    let amount = ["--instances", "2", "--views", "6", "--out", folder];
    let output = sandbox.tabula(&[&["simulate", "views"], &choice[..], &amount[..]].concat());
    assert!(output.status.success(), "{output:?}");
}

fn names_compared(objects: &[Value]) -> Vec<&str> {
    let categories = objects.iter().filter_map(|o| o["categories"].as_array());
    let names = categories.flatten().filter_map(|c| c["label"].as_str());
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    names.dedup();
    names
}

fn wait_until_compared(daemon: &Daemon<'_>) {
    daemon.wait_for("objects are compared with what was learned", |objects| {
        names_compared(objects) == ["bowl", "cereal-box"]
    });
}

#[test]
fn folder_of_views_is_learned_and_kept() {
    let sandbox = Sandbox::new();
    let folder = tempfile::tempdir().unwrap();
    write_views(&sandbox, folder.path());
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let report = daemon.ask(&["learn", folder.path().to_str().unwrap()]);
    assert_eq!(report["n_categories"], 2, "{report}");
    assert_eq!(report["n_objects"], 4, "{report}");
    let n_views = report["n_views"].as_u64().unwrap();
    assert!((16..=24).contains(&n_views), "{report}");
    wait_until_compared(&daemon);
    daemon.stop();

    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let categories = daemon.ask(&["categories"]);
    let categories = categories["categories"].as_array().unwrap();
    let stored = categories.iter().filter_map(|c| c["n_views"].as_u64());
    assert_eq!(stored.sum::<u64>(), n_views, "{categories:?}");
    wait_until_compared(&daemon);
    daemon.stop();
}

#[test]
fn folder_learned_twice_is_stored_once_and_relabelled_after_forgetting() {
    let sandbox = Sandbox::new();
    let folder = tempfile::tempdir().unwrap();
    write_views(&sandbox, folder.path());
    let path = folder.path().to_str().unwrap();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let learn = || daemon.ask(&["learn", path]);
    let categories = || without_times(daemon.ask(&["categories"]));
    let first = learn();
    let n_views = first["n_views"].as_u64().unwrap();
    assert_eq!(first["n_views_changed"], n_views, "{first}");
    let known = categories();

    let again = learn();
    assert_eq!(again["n_views"], n_views, "{again}");
    assert_eq!(again["n_views_changed"], 0, "{again}");
    assert_eq!(categories(), known);
    let stats = daemon.ask(&["memory", "stats"]);
    assert_eq!(stats["n_named"], n_views, "{stats}");

    let forgot = daemon.ask(&["forget", "bowl"]);
    let n_bowls = forgot["n_views_changed"].as_u64().unwrap();
    assert!((1..n_views).contains(&n_bowls), "{forgot}");
    let named_again = learn();
    assert_eq!(named_again["n_views_changed"], n_bowls, "{named_again}");
    assert_eq!(categories(), known);
    daemon.stop();
}

/// Removes the labelling times, which differ between runs.
fn without_times(mut categories: Value) -> Value {
    for category in categories["categories"].as_array_mut().unwrap() {
        let times = category.as_object_mut().unwrap().remove("last_taught_ns");
        assert!(times.is_some(), "{category}");
    }
    categories
}

#[test]
fn folder_learned_by_two_robots_gives_the_same_views() {
    let (ours, theirs) = (Sandbox::new(), Sandbox::new());
    let folder = tempfile::tempdir().unwrap();
    write_views(&ours, folder.path());
    let path = folder.path().to_str().unwrap();
    let exported = folder.path().join("theirs.tabula");
    let exported = exported.to_str().unwrap();
    let daemon = theirs.start(&["--source", "synthetic:0"]);
    daemon.ask(&["learn", path]);
    daemon.ask(&["memory", "export", exported]);
    daemon.stop();
    let daemon = ours.start(&["--source", "synthetic:0"]);
    let learned = daemon.ask(&["learn", path]);
    let known = without_times(daemon.ask(&["categories"]));
    let imported = daemon.ask(&["memory", "import", exported]);
    // Besides the folder's, the key views of the other table, which have no name.
    let n_views = imported["n_views"].as_u64().unwrap();
    assert!(
        n_views >= learned["n_views"].as_u64().unwrap(),
        "{imported}"
    );
    assert_eq!(without_times(daemon.ask(&["categories"])), known);
    let stats = daemon.ask(&["memory", "stats"]);
    assert_eq!(stats["n_named"], learned["n_views"], "{stats}");
    daemon.stop();
}

#[test]
fn folder_without_up_direction_or_views_is_refused() {
    let sandbox = Sandbox::new();
    let folder = tempfile::tempdir().unwrap();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let path = folder.path().to_str().unwrap();
    let (_, sentence) = daemon.refused(&["learn", path]);
    assert!(sentence.contains(path), "{sentence}");
    std::fs::create_dir(folder.path().join("mug")).unwrap();
    std::fs::write(folder.path().join("mug/1.pcd"), "rubbish").unwrap();
    let (_, sentence) = daemon.refused(&["learn", path]);
    assert!(sentence.contains("--up z"), "{sentence}");
    let (code, sentence) = daemon.refused(&["learn", path, "--up", "z"]);
    assert_eq!(code, 1, "{sentence}");
    assert!(sentence.contains("no usable view"), "{sentence}");
    assert!(sentence.contains("mug/1.pcd"), "{sentence}");
    daemon.stop();
}

/// Writes a cloud of a cylinder, 0.8 times as wide as high, in a unit of which it is so high.
fn write_cylinder(path: &Path, height: f32) {
    let radius = 0.4 * height;
    let at = |number: u16| {
        let angle = f32::from(number % 40) * std::f32::consts::TAU / 40.0;
        let z = height * f32::from(number / 40) / 11.0;
        format!("{} {} {z}\n", radius * angle.cos(), radius * angle.sin())
    };
    let points: String = (0..480).map(at).collect();
    let header = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 480\n\
                  HEIGHT 1\nPOINTS 480\nDATA ascii\n";
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, format!("{header}{points}")).unwrap();
}

#[test]
fn folder_in_millimetres_is_learned_in_metres_and_another_size_is_refused() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    let learn = |unit: Option<&'static str>| {
        let words = ["learn", path, "--up", "z"].into_iter();
        let unit = unit.map(|unit| ["--unit", unit]);
        words.chain(unit.into_iter().flatten()).collect::<Vec<_>>()
    };
    write_cylinder(&folder.path().join("mug/1.pcd"), 100.0);
    let (_, sentence) = daemon.refused(&learn(Some("m")));
    assert!(sentence.contains("0.005 to 2 m"), "{sentence}");

    write_cylinder(&folder.path().join("moon/1.pcd"), 1e30);
    let report = daemon.ask(&learn(None));
    assert_eq!(report["n_views"], 1, "{report}");
    let note = report["notes"][0].as_str().unwrap();
    assert!(
        note.contains("mug") && note.contains("millimetres"),
        "{note}"
    );
    let left_out = report["left_out"][0].as_str().unwrap();
    assert!(left_out.contains("moon/1.pcd"), "{left_out}");
    let views = daemon.ask(&["memory", "inspect", "--category", "mug"]);
    let size_m = views["views"][0]["size_m"].as_array().unwrap();
    let size_mm: Vec<f64> = size_m
        .iter()
        .map(|side| (side.as_f64().unwrap() * 1e3).round())
        .collect();
    assert_eq!(size_mm, [80.0, 80.0, 100.0]);

    // A unit that is given is no guess.
    let again = daemon.ask(&learn(Some("mm")));
    assert_eq!(again["notes"], serde_json::json!([]), "{again}");
    assert_eq!(again["n_views_changed"], 0, "{again}");
    daemon.stop();
}
