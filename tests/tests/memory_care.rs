//! Memory maintenance with `tabula memory`, with and without a running daemon.

use crate::daemon::{Daemon, Sandbox, with_mounts};
use crate::skeleton::{id, wait_for_all};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Daemon with one labelled object, and the track of that object.
fn taught(sandbox: &Sandbox) -> (Daemon<'_>, String) {
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    let objects = wait_for_all(&daemon, 0);
    let track = id(&objects[0]);
    daemon.ask(&["teach", &track, "mug", "--author", "anna"]);
    (daemon, track)
}

fn names(document: &Value) -> Vec<(String, u64)> {
    let categories = document["categories"].as_array().unwrap().iter();
    let named = categories.map(|category| {
        let name = category["category"].as_str().unwrap().to_owned();
        (name, category["n_views"].as_u64().unwrap())
    });
    named.collect()
}

/// JSON document of `tabula` without a daemon.
fn offline(sandbox: &Sandbox, arguments: &[&str]) -> Value {
    let output = sandbox.tabula(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{arguments:?}: {output:?}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn labels_are_undone_renamed_and_merged() {
    let sandbox = Sandbox::new();
    let (daemon, track) = taught(&sandbox);
    let contradicted = daemon
        .refused(&["teach", &track, "bowl", "--author", "bert"])
        .1;
    assert!(
        contradicted.contains("anna taught it as mug"),
        "{contradicted}"
    );
    daemon.ask(&["correct", &track, "bowl", "--author", "bert"]);
    daemon.ask(&["undo", "--author", "bert"]);
    assert_eq!(names(&daemon.ask(&["categories"]))[0].0, "mug");
    let (_, nothing) = daemon.refused(&["undo", "--author", "bert"]);
    assert!(nothing.contains("nothing to undo"), "{nothing}");
    daemon.ask(&["rename", "mug", "coffee mug"]);
    let (_, unknown) = daemon.refused(&["merge", "coffee mug", "cup"]);
    assert!(unknown.contains("cup"), "{unknown}");
    assert_eq!(names(&daemon.ask(&["categories"]))[0].0, "coffee mug");
    daemon.ask(&["forget", "--track", &track]);
    assert_eq!(names(&daemon.ask(&["categories"])), []);
    daemon.ask(&["undo"]);
    assert_eq!(names(&daemon.ask(&["categories"]))[0].0, "coffee mug");
    let history = daemon.ask(&["memory", "history"]);
    let entries = history["entries"].as_array().unwrap();
    let printed: Vec<&str> = entries
        .iter()
        .filter_map(|e| e["author"].as_str())
        .collect();
    assert!(
        printed.contains(&"anna") && printed.contains(&"bert"),
        "{printed:?}"
    );
    let bert = entries.iter().find(|e| e["author"] == "bert").unwrap();
    assert!(bert["contradiction"].is_string(), "{bert}");
    daemon.stop();
}

#[test]
fn export_is_imported_by_another_robot() {
    let (ours, theirs) = (Sandbox::new(), Sandbox::new());
    let file = ours.home().join("memory.export");
    let file = file.to_str().unwrap();
    let (daemon, track) = taught(&ours);
    let put = ["knowledge", "put", "shelf of the mugs"];
    let text = ours.home().join("note.txt");
    std::fs::write(&text, "upper\n").unwrap();
    daemon.ask(&[&put[..], &[text.to_str().unwrap()]].concat());
    let exported = daemon.ask(&["memory", "export", file]);
    assert!(exported["n_views"].as_u64().unwrap() > 0, "{exported}");
    assert_eq!(exported["n_documents"], 1);
    let inspected = daemon.ask(&["memory", "inspect", "--track", &track]);
    let view = &inspected["views"][0];
    assert_eq!(view["author"], "anna", "{view}");
    assert!(view["cloud_bytes"].as_u64().unwrap() > 100, "{view}");
    daemon.stop();

    // Another robot, which need not have seen anything.
    theirs.start(&["--source", "synthetic:0"]).stop();
    let import = ["memory", "import", file, "--rename", "mug=cup"];
    let imported = offline(&theirs, &import);
    assert!(
        imported["n_views_changed"].as_u64().unwrap() > 0,
        "{imported}"
    );
    let again = offline(&theirs, &import);
    assert_eq!(again["n_views_changed"], 0, "{again}");
    let daemon = theirs.start(&["--source", "synthetic:0"]);
    assert_eq!(names(&daemon.ask(&["categories"]))[0].0, "cup");
    let note = daemon.ask(&["knowledge", "get", "shelf of the mugs"]);
    assert_eq!(note["text"], "upper\n");
    daemon.wait_for("the object is compared with the imported one", |objects| {
        objects.iter().any(|object| object["label"] == "cup")
    });
    let verified = daemon.ask(&["memory", "verify"]);
    assert_eq!(verified["n_findings"], 0, "{verified}");
    daemon.stop();
}

#[test]
fn export_after_export_is_not_refused() {
    let sandbox = Sandbox::new();
    let (daemon, _) = taught(&sandbox);
    let mut files = (0..5).map(|number| {
        let file = sandbox.home().join(format!("{number}.tabula"));
        daemon.ask(&["memory", "export", file.to_str().unwrap()]);
        std::fs::read(file).unwrap()
    });
    let first = files.next().unwrap();
    assert!(files.all(|file| !file.is_empty()) && !first.is_empty());
    daemon.stop();
}

#[test]
fn import_without_a_daemon_makes_the_memory_of_a_new_robot() {
    let (ours, theirs) = (Sandbox::new(), Sandbox::new());
    let (daemon, _) = taught(&ours);
    let file = ours.home().join("backup.tabula");
    let file = file.to_str().unwrap();
    daemon.ask(&["memory", "export", file]);
    daemon.stop();
    let other = ["memory", "stats"];
    let refused = theirs.tabula(&other);
    assert_eq!(refused.status.code(), Some(3), "{refused:?}");
    assert_eq!(theirs.home().read_dir().unwrap().count(), 0);

    let imported = theirs.tabula(&["memory", "import", file, "--json"]);
    assert!(imported.status.success(), "{imported:?}");
    let told = String::from_utf8(imported.stderr).unwrap();
    assert!(told.contains("making a new memory"), "{told}");
    let imported: Value = serde_json::from_slice(&imported.stdout).unwrap();
    assert_eq!(imported["n_left_out"], 0, "{imported}");
    assert_ne!(imported["n_views"], 0, "{imported}");
    let stats = offline(&theirs, &other);
    assert_ne!(stats["n_named"], 0, "{stats}");
    let daemon = theirs.start(&["--source", "synthetic:0"]);
    assert_eq!(names(&daemon.ask(&["categories"]))[0].0, "mug");
    daemon.stop();
}

#[test]
fn import_of_a_damaged_export_is_refused_and_changes_nothing() {
    let sandbox = Sandbox::new();
    let (daemon, _) = taught(&sandbox);
    let file = sandbox.home().join("memory.export");
    daemon.ask(&["memory", "export", file.to_str().unwrap()]);
    let whole = std::fs::read(&file).unwrap();
    let before = daemon.changes();
    let refuse = |bytes: &[u8]| {
        let path = sandbox.home().join("hostile");
        std::fs::write(&path, bytes).unwrap();
        daemon
            .refused(&["memory", "import", path.to_str().unwrap()])
            .1
    };
    assert!(refuse(b"").contains("no exported memory"));
    assert!(refuse(b"TABULA MEMORY 9\nxxxx").contains("newer version"));
    for at in (16..whole.len()).step_by(whole.len() / 20) {
        assert!(refuse(&whole[..at]).contains("damaged"), "cut at {at}");
        let mut flipped = whole.clone();
        flipped[at] ^= 1;
        assert!(refuse(&flipped).contains("damaged"), "flipped at {at}");
    }
    let twice = [&whole[..], &whole[..]].concat();
    assert!(refuse(&twice).contains("damaged"));
    assert_eq!(daemon.changes(), before);
    daemon.stop();
}

/// Path of the database's largest file.
fn largest(folder: &Path) -> PathBuf {
    let files = std::fs::read_dir(folder).unwrap().flatten();
    let files = files.map(|entry| entry.path()).filter(|path| {
        let extension = path.extension().and_then(|e| e.to_str());
        matches!(extension, Some("ldb" | "wal"))
    });
    files
        .max_by_key(|path| path.metadata().unwrap().len())
        .unwrap()
}

#[test]
fn damage_is_found_reported_and_repaired() {
    let sandbox = Sandbox::new();
    let (daemon, _) = taught(&sandbox);
    daemon.ask(&["memory", "compact", "--forgotten-days", "0"]);
    daemon.stop();
    let database = sandbox.home().join("perceptual-memory/database");
    let file = largest(&database);
    let mut bytes = std::fs::read(&file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&file, &bytes).unwrap();
    // Verifying changes nothing.
    let verified = sandbox.tabula(&["memory", "verify", "--json"]);
    assert_eq!(verified.status.code(), Some(1), "{verified:?}");
    assert_eq!(std::fs::read(&file).unwrap(), bytes);
    // The repair keeps the intact records and reports the lost ones.
    let repaired = sandbox.tabula(&["memory", "repair", "--json"]);
    let document: Value = serde_json::from_slice(&repaired.stdout).unwrap();
    let what = document["repaired"]["what"].as_str().unwrap();
    assert!(what.contains("lost:"), "{what}");
    assert!(
        sandbox
            .home()
            .join("perceptual-memory/database.damaged-1")
            .exists()
    );
    assert_eq!(offline(&sandbox, &["memory", "verify"])["n_findings"], 0);
    let daemon = sandbox.start(&["--source", "synthetic:0"]);
    assert_eq!(daemon.ask(&["memory", "verify"])["n_findings"], 0);
    daemon.stop();
}

/// `tabula` with the home folder mounted in another way: success, and its sentences.
fn with_home_mounted(sandbox: &Sandbox, mounts: &str, arguments: &[&str]) -> (bool, String) {
    let home = sandbox.home().to_str().unwrap();
    let mounts = mounts.replace("HOME", home);
    let mut command = sandbox.command("tabula");
    let output = with_mounts(command.args(arguments), &mounts)
        .output()
        .unwrap();
    let sentences = String::from_utf8(output.stderr).unwrap();
    (output.status.success(), sentences)
}

#[test]
fn as_root_disk_that_is_read_only_or_full_takes_nothing_and_loses_nothing() {
    let sandbox = Sandbox::new();
    let (daemon, _) = taught(&sandbox);
    let file = sandbox.home().join("memory.export");
    let file = file.to_str().unwrap();
    daemon.ask(&["memory", "export", file]);
    daemon.stop();
    let before = offline(&sandbox, &["memory", "stats"])["sequence"].clone();

    let read_only = "mount --bind HOME HOME && mount -o remount,ro,bind HOME";
    let (is_read, sentence) = with_home_mounted(&sandbox, read_only, &["memory", "stats"]);
    assert!(is_read, "{sentence}");
    let put = ["knowledge", "put", "large", "/proc/cpuinfo"];
    let (is_put, refusal) = with_home_mounted(&sandbox, read_only, &put);
    assert!(!is_put, "{refusal}");
    for sentence in [sentence, refusal] {
        assert!(sentence.contains("Read-only file system"), "{sentence}");
        assert!(
            sentence.contains("belongs to the daemon's user"),
            "{sentence}"
        );
    }

    // A copy of the home folder on a disk that has no room for anything more.
    let full = "mkdir -p /tmp/full-$$ && cp -r HOME/. /tmp/full-$$ && \
                mount -t tmpfs -o size=2m none HOME && cp -r /tmp/full-$$/. HOME && \
                rm -r /tmp/full-$$ && (head -c 4m /dev/zero > HOME/rubbish; true)";
    let (is_put, sentence) = with_home_mounted(&sandbox, full, &put);
    assert!(!is_put, "{sentence}");
    assert!(sentence.contains("No space left on device"), "{sentence}");
    assert!(
        sentence.contains("see that the disk has room"),
        "{sentence}"
    );

    assert_eq!(offline(&sandbox, &["memory", "verify"])["n_findings"], 0);
    assert_eq!(offline(&sandbox, &["memory", "stats"])["sequence"], before);
}

#[test]
fn second_process_on_the_same_memory_is_refused() {
    let sandbox = Sandbox::new();
    let (daemon, _) = taught(&sandbox);
    // Of another domain, so that it finds no daemon and opens the memory itself.
    let mut command = sandbox.command("tabula");
    command.env("TABULA_DOMAIN", format!("{}-b", sandbox.domain));
    let output = command.args(["memory", "stats"]).output().unwrap();
    assert!(!output.status.success());
    let sentence = String::from_utf8(output.stderr).unwrap();
    assert!(
        sentence.contains("is open in another process"),
        "{sentence}"
    );
    assert_eq!(names(&daemon.ask(&["categories"]))[0].0, "mug");
    daemon.stop();
}
