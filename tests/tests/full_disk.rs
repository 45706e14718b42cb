//! A disk without room: the memory answers what it can, says that it is degraded, and recovers by
//! itself.

use crate::daemon::{Daemon, Sandbox, eventually};
use crate::skeleton::{id, wait_for_all};
use message::ProcessKind;
use rustix::process::Signal;
use serde_json::Value;
use std::fs::File;
use std::io::Write;
use std::path::PathBuf;

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];

/// File that takes all room of a daemon's disk; removed on drop.
pub(crate) struct Rubbish(PathBuf);

impl Rubbish {
    /// Fills the disk of a daemon in a sandbox with a disk of its own.
    pub(crate) fn fill(daemon: &Daemon<'_>) -> Self {
        // The disk is mounted in the daemon's namespace only.
        let root = PathBuf::from(format!("/proc/{}/root", daemon.parent_id()));
        let home = daemon.sandbox.home().strip_prefix("/").unwrap();
        let path = root.join(home).join("rubbish");
        let mut file = File::create(&path).unwrap();
        while file.write_all(&[1; 4096]).is_ok() {}
        Self(path)
    }
}

impl Drop for Rubbish {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Waits until the memory is degraded, and returns why.
fn wait_until_degraded(daemon: &Daemon<'_>) -> String {
    let mut note = String::new();
    eventually("the memory is degraded", || {
        let health = daemon
            .health(ProcessKind::MEMORY.word())
            .unwrap_or_default();
        note = health["note"].as_str().unwrap_or_default().to_owned();
        health["state"] == "degraded"
    });
    note
}

/// Reading without disk: categories, history, recognition, and an export.
fn check_reading(daemon: &Daemon<'_>, track: &str) {
    let categories = daemon.ask(&["categories"]);
    assert_eq!(categories["categories"][0]["category"], "mug");
    let history = daemon.ask(&["memory", "history"]);
    assert!(history["last_sequence"].as_u64() >= Some(2), "{history}");
    assert_eq!(daemon.ask(&["ask", track])["label"], "mug");
    let elsewhere = tempfile::tempdir().unwrap();
    let file = elsewhere.path().join("memory.export");
    let exported = daemon.ask(&["memory", "export", file.to_str().unwrap()]);
    assert!(exported["n_views"].as_u64() >= Some(1), "{exported}");
}

#[test]
#[ignore = "needs root"]
fn as_root_memory_on_a_full_disk_reads_exports_and_recovers() {
    let sandbox = Sandbox::on_own_disk("");
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    let (track, other) = (id(&objects[0]), id(&objects[1]));
    daemon.ask(&["teach", &track, "mug"]);
    daemon.wait_for("the lesson is seen", |objects| {
        objects.iter().any(|object| object["label"] == "mug")
    });
    let pid = daemon.pid(ProcessKind::MEMORY);

    let rubbish = Rubbish::fill(&daemon);
    // Larger than what is left in the last block of the log.
    let mut large = tempfile::NamedTempFile::new().unwrap();
    large.write_all(&vec![b'x'; 100_000]).unwrap();
    let (_, sentence) =
        daemon.refused(&["knowledge", "put", "large", large.path().to_str().unwrap()]);
    let is_told = sentence.contains("No space left");
    assert!(is_told, "{sentence}\n{}", daemon.log());
    let note = wait_until_degraded(&daemon);
    assert!(note.contains("can only be read"), "{note}");
    check_reading(&daemon, &track);

    // A memory that starts without room answers the same.
    daemon.signal(ProcessKind::MEMORY, Signal::KILL);
    eventually("the memory is another process", || {
        let now = daemon.pid(ProcessKind::MEMORY);
        now.is_some() && now != pid
    });
    wait_until_degraded(&daemon);
    check_reading(&daemon, &track);
    let pid = daemon.pid(ProcessKind::MEMORY);

    drop(rubbish);
    eventually("the memory is ready again", || {
        let health = daemon
            .health(ProcessKind::MEMORY.word())
            .unwrap_or_default();
        health["state"] == "ready"
    });
    daemon.ask(&["teach", &other, "bowl"]);
    assert_eq!(daemon.pid(ProcessKind::MEMORY), pid, "it recovers in place");
    let log = daemon.log();
    let n_lines = log.matches("the store can only be read").count();
    assert!((2..=4).contains(&n_lines), "{n_lines} lines\n{log}");
    let verified: Value = daemon.ask(&["memory", "verify"]);
    assert_eq!(verified["n_findings"], 0, "{verified}");
    daemon.stop();
}
