//! A folder of labelled views is learned by the running daemon.

use crate::daemon::{Daemon, Place};
use serde_json::Value;
use std::path::Path;

/// Writes views of two generated categories.
fn write_views(place: &Place, folder: &Path) {
    let folder = folder.to_str().unwrap();
    let choice = ["--category", "bowl", "--category", "cereal-box"];
    let amount = ["--instances", "2", "--views", "6", "--out", folder];
    let output = place.tabula(&[&["simulate", "views"], &choice[..], &amount[..]].concat());
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
fn a_folder_of_views_is_learned_and_kept() {
    let place = Place::new();
    let folder = tempfile::tempdir().unwrap();
    write_views(&place, folder.path());
    let daemon = place.start(&["--source", "synthetic:0"]);
    let report = daemon.ask(&["learn", folder.path().to_str().unwrap()]);
    assert_eq!(report["n_categories"], 2, "{report}");
    assert_eq!(report["n_objects"], 4, "{report}");
    let n_views = report["n_views"].as_u64().unwrap();
    assert!((16..=24).contains(&n_views), "{report}");
    wait_until_compared(&daemon);
    daemon.stop();

    let daemon = place.start(&["--source", "synthetic:0"]);
    let categories = daemon.ask(&["categories"]);
    let categories = categories["categories"].as_array().unwrap();
    let stored = categories.iter().filter_map(|c| c["n_views"].as_u64());
    assert_eq!(stored.sum::<u64>(), n_views, "{categories:?}");
    wait_until_compared(&daemon);
    daemon.stop();
}

#[test]
fn what_does_not_tell_what_is_up_or_holds_no_views_is_refused() {
    let place = Place::new();
    let folder = tempfile::tempdir().unwrap();
    let daemon = place.start(&["--source", "synthetic:0"]);
    let path = folder.path().to_str().unwrap();
    let (_, sentence) = daemon.refused(&["learn", path]);
    assert!(sentence.contains(path), "{sentence}");
    std::fs::create_dir(folder.path().join("mug")).unwrap();
    std::fs::write(folder.path().join("mug/1.pcd"), "rubbish").unwrap();
    let (_, sentence) = daemon.refused(&["learn", path]);
    assert!(sentence.contains("--up z"), "{sentence}");
    let report = daemon.ask(&["learn", path, "--up", "z"]);
    assert_eq!(report["n_views"], 0, "{report}");
    assert_eq!(report["left_out"].as_array().unwrap().len(), 1, "{report}");
    daemon.stop();
}
