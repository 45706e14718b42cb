//! Wall clock of the memory that a test can set, by the library libfaketime. The monotonic clock
//! goes on.
//!
//! Only the memory has the library: it makes the processes of a tree share a semaphore, so that the
//! end of one could stop all others.

use crate::daemon::{Daemon, Sandbox};
use message::ProcessKind;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Folders in which Debian installs the library.
const FOLDERS: [&str; 3] = [
    "/usr/lib/x86_64-linux-gnu/faketime",
    "/usr/lib/aarch64-linux-gnu/faketime",
    "/usr/lib/faketime",
];

/// Name of the file with the offset of the clock.
const CLOCK: &str = "clock";

/// Library for programs with threads, if it is installed.
fn library() -> Option<PathBuf> {
    let paths = FOLDERS.map(|folder| Path::new(folder).join("libfaketimeMT.so.1"));
    paths.into_iter().find(|path| path.exists())
}

/// Sandbox whose memory has a clock that can be set; `None` without the library.
pub(super) fn sandbox() -> Option<Sandbox> {
    let script = format!(
        "export FAKETIME_TIMESTAMP_FILE=\"$XDG_RUNTIME_DIR/{CLOCK}\"\n\
         export FAKETIME_CACHE_DURATION=1 FAKETIME_DONT_FAKE_MONOTONIC=1\n\
         export LD_PRELOAD='{}'\n\
         exec \"$REAL\" \"$@\"",
        library()?.display()
    );
    let sandbox = Sandbox::with_script(ProcessKind::MEMORY, &script);
    set(&sandbox, "+0");
    Some(sandbox)
}

/// Sets the clock, as an offset such as `+3h`.
pub(super) fn set(sandbox: &Sandbox, offset: &str) {
    std::fs::write(sandbox.shared_file(CLOCK), offset).unwrap();
}

/// Difference between the clock of the memory and this process's, seconds, by its last change.
pub(super) fn offset_s(daemon: &Daemon<'_>) -> f64 {
    let history = daemon.ask(&["memory", "history", "--count", "1"]);
    let wall_ns = history["entries"][0]["wall_ns"].as_u64().unwrap();
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
    wall_ns as f64 * 1e-9 - now.as_secs_f64()
}
