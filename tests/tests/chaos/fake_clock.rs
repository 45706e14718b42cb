//! Clock of a daemon that a test can set, by the library libfaketime: the monotonic clock goes on.

use crate::daemon::{Daemon, Sandbox};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Folders in which Debian installs the library.
const FOLDERS: [&str; 3] = [
    "/usr/lib/x86_64-linux-gnu/faketime",
    "/usr/lib/aarch64-linux-gnu/faketime",
    "/usr/lib/faketime",
];

/// Library for programs with threads, if it is installed.
fn library() -> Option<PathBuf> {
    let paths = FOLDERS.map(|folder| Path::new(folder).join("libfaketimeMT.so.1"));
    paths.into_iter().find(|path| path.exists())
}

/// Lets the programs of a sandbox have a clock that can be set; `false` without the library.
pub(super) fn prepare(sandbox: &mut Sandbox) -> bool {
    let Some(library) = library() else {
        return false;
    };
    let file = file(sandbox);
    set(sandbox, "+0");
    sandbox.set_variable("LD_PRELOAD", &library.display().to_string());
    sandbox.set_variable("FAKETIME_TIMESTAMP_FILE", &file.display().to_string());
    sandbox.set_variable("FAKETIME_CACHE_DURATION", "1");
    sandbox.set_variable("FAKETIME_DONT_FAKE_MONOTONIC", "1");
    true
}

/// Sets the clock, as an offset such as `+3h`.
pub(super) fn set(sandbox: &Sandbox, offset: &str) {
    std::fs::write(file(sandbox), offset).unwrap();
}

/// Difference between the clock of the memory and this process's, seconds, by its last change.
pub(super) fn offset_s(daemon: &Daemon<'_>) -> f64 {
    let history = daemon.ask(&["memory", "history", "--count", "1"]);
    let wall_ns = history["entries"][0]["wall_ns"].as_u64().unwrap();
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
    wall_ns as f64 * 1e-9 - now.as_secs_f64()
}

fn file(sandbox: &Sandbox) -> PathBuf {
    sandbox.shared_file("clock")
}
