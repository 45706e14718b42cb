//! One writer of the files that users name: elsewhere nothing creates, replaces or renames a file.

use crate::language::{root, workspace};
use std::collections::BTreeSet;
use std::path::Path;

/// Calls that create, replace or rename a file.
const CALLS: [&str; 14] = [
    "File::create(",
    "File::create_new(",
    "fs::write(",
    "fs::rename(",
    "fs::copy(",
    "fs::hard_link(",
    "create(true)",
    "create_new(true)",
    ".persist(",
    "NamedTempFile",
    "tempfile_in(",
    "renameat",
    "OFlags::CREATE",
    "OFlags::TMPFILE",
];

/// Sources that may use these calls, each with its reason.
const OWNERS: [(&str, &str); 15] = [
    (
        "shared/core/file-access/src/output_file.rs",
        "the one writer of the files that users name",
    ),
    (
        "shared/core/dataset/src/fakenect_folder/writer.rs",
        "index of a new recording, to which lines are appended; never replaces",
    ),
    (
        "services/recorder/src/recording_folder.rs",
        "recordings, which grow under a name of their own; never replaces",
    ),
    (
        "services/recorder/src/recover.rs",
        "recovered recording; never replaces",
    ),
    (
        "shared/platform/service/src/manuals.rs",
        "manual pages and completions of a package that is built",
    ),
    (
        "shared/platform/service/src/service_manager.rs",
        "marker in the folder that systemd makes",
    ),
    (
        "shared/platform/control-client/src/spawned_daemon.rs",
        "log in a temporary folder of its own",
    ),
    (
        "shared/platform/arm-interface/src/stop_word.rs",
        "stop word in the run folder",
    ),
    (
        "shared/platform/channel/src/trusted_folder.rs",
        "locks and states in the run folder",
    ),
    (
        "shared/memory/memory-requests/src/upload.rs",
        "file without a name",
    ),
    (
        "shared/memory/perceptual-memory/src/watermark.rs",
        "file of the store",
    ),
    (
        "shared/memory/durable-leveldb/src/durable_env.rs",
        "files of the store",
    ),
    (
        "shared/memory/durable-leveldb/src/durable_file.rs",
        "files of the store",
    ),
    (
        "shared/memory/durable-leveldb/src/store_folder.rs",
        "lock and folders of the store",
    ),
    (
        "shared/memory/durable-leveldb/src/synced_file.rs",
        "files of the store",
    ),
];

/// `true` for a source that runs in a program of a user.
pub(crate) fn is_of_program(path: &Path) -> bool {
    let is_aside = |part: &str| ["tests", "benches", "examples", "fuzz"].contains(&part);
    let mut parts = path.iter().filter_map(|part| part.to_str());
    let is_test_support = ["shared/core/test-data", "shared/core/mutation-fuzzing"]
        .iter()
        .any(|support| path.starts_with(support));
    !is_test_support && !path.ends_with("tests.rs") && !parts.any(is_aside)
}

/// Lines with their numbers, without comments, up to the tests of the file.
pub(crate) fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let text = text.split("\n#[cfg(test)]\nmod ").next().unwrap();
    let lines = text.lines().enumerate();
    lines
        .map(|(number, line)| (number + 1, line))
        .filter(|(_, line)| !line.trim_start().starts_with("//"))
}

/// `true` where a line makes a call, not one of a longer name such as `LogFile::create(`.
fn makes(line: &str, call: &str) -> bool {
    line.match_indices(call)
        .any(|(at, _)| !line[..at].ends_with(char::is_alphanumeric))
}

#[test]
fn writers_of_files_are_the_named_owners() {
    let (mut strangers, mut seen) = (Vec::new(), BTreeSet::new());
    for (path, text) in workspace() {
        let path = path.strip_prefix(root()).unwrap();
        if !is_of_program(path) {
            continue;
        }
        for (number, line) in code(&text) {
            if !CALLS.iter().any(|call| makes(line, call)) {
                continue;
            }
            match OWNERS.iter().find(|(owner, _)| path == Path::new(owner)) {
                Some((owner, _)) => drop(seen.insert(*owner)),
                None => strangers.push(format!("{}:{number}: {}", path.display(), line.trim())),
            }
        }
    }
    assert!(
        strangers.is_empty(),
        "files that users name are written by file_access::write_atomic or file_access::OutputFile, which \
         replace only regular files:\n{}",
        strangers.join("\n")
    );
    let idle: Vec<_> = OWNERS.iter().filter(|(o, _)| !seen.contains(o)).collect();
    assert!(idle.is_empty(), "these write no files: {idle:?}");
}
