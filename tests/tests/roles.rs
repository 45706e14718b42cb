//! Accounts and roles: the group of the socket, reading, teaching and administering, undo by
//! rights, and files that other users cannot read.

use crate::daemon::{Daemon, Sandbox, WATCHDOG, WITH_CAMERA, program};
use crate::skeleton::{id, wait_for_all};
use control_protocol::{MutationId, RefusalKind, request};
use daemon_client::{CallError, DaemonClient};
use serde_json::Value;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// The synthetic table at a low rate, since several daemons share the cores.
const TABLE: [&str; 4] = ["--source", "synthetic:0", "--rate", "10"];
/// A user without rights of its own.
const NOBODY: u32 = 65_534;
/// Id of the group `tabula` in these tests.
const GROUP: u32 = 54_321;

/// Copy of the command-line program that any account may run.
fn program_for_all() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("tabula");
    std::fs::copy(program("tabula"), &copy).unwrap();
    for path in [folder.path(), &copy] {
        std::fs::set_permissions(path, PermissionsExt::from_mode(0o755)).unwrap();
    }
    folder
}

/// Command that runs as an account in one group.
fn as_account(sandbox: &Sandbox, folder: &Path, group: u32, arguments: &[&str]) -> Command {
    let own = sandbox.command("tabula");
    let mut command = Command::new("setpriv");
    command
        .args([&format!("--reuid={NOBODY}"), &format!("--regid={group}")])
        .arg("--clear-groups")
        .arg(folder.join("tabula"))
        .args(arguments)
        .envs(
            own.get_envs()
                .filter_map(|(name, value)| Some((name, value?))),
        )
        .current_dir("/")
        .stdin(Stdio::null());
    command
}

/// Output of `tabula` as a member of the group.
fn as_member(sandbox: &Sandbox, folder: &TempDir, arguments: &[&str]) -> Output {
    let mut command = as_account(sandbox, folder.path(), GROUP, arguments);
    command.output().unwrap()
}

fn allowed(output: &Output) {
    assert!(output.status.success(), "{output:?}");
}

/// Sentence of a command that must be refused.
fn refused(output: &Output) -> String {
    let sentence = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success(), "{sentence}");
    sentence
}

#[test]
#[ignore = "needs root"]
fn as_root_other_accounts_need_the_group() {
    let sandbox = Sandbox::with_group(GROUP);
    let folder = program_for_all();
    let daemon = sandbox.start(&TABLE);
    let socket = sandbox.run_folder().control_socket(&sandbox.domain);
    let metadata = std::fs::metadata(&socket).unwrap();
    assert_eq!((metadata.gid(), metadata.mode() & 0o777), (GROUP, 0o660));
    let folder_metadata = std::fs::metadata(socket.parent().unwrap()).unwrap();
    assert_eq!(folder_metadata.gid(), GROUP);
    assert_eq!(folder_metadata.mode() & 0o777, 0o750);

    for arguments in [&["objects", "--json"][..], &["status"], &["categories"]] {
        allowed(&as_member(&sandbox, &folder, arguments));
        let mut stranger = as_account(&sandbox, folder.path(), NOBODY, arguments);
        let stranger = stranger.output().unwrap();
        assert_eq!(stranger.status.code(), Some(1), "{stranger:?}");
        let sentence = refused(&stranger);
        assert!(
            sentence.contains("ask for membership in the group tabula"),
            "{sentence}"
        );
    }
    let member = as_member(&sandbox, &folder, &["status", "--json"]);
    let status: Value = serde_json::from_slice(&member.stdout).unwrap();
    let expected = status["expected"].as_array().unwrap();
    assert_eq!(expected.len(), WITH_CAMERA.len(), "{status:#}");
    daemon.stop();
}

#[test]
#[ignore = "needs root"]
fn as_root_reader_reads_and_stops_and_changes_nothing() {
    let sandbox = Sandbox::with_group(GROUP);
    sandbox.configure("[gateway]\nteacher_group = \"no such group\"\n");
    let folder = program_for_all();
    let daemon = sandbox.start(&TABLE);
    let track = id(&wait_for_all(&daemon, 0)[0]);
    for reading in [
        &["objects"][..],
        &["ask", &track],
        &["categories"],
        &["memory", "history"],
        &["knowledge", "list"],
        &["model", "list"],
    ] {
        allowed(&as_member(&sandbox, &folder, reading));
    }
    for changing in [
        &["teach", &track, "mug"][..],
        &["undo"],
        &["redo"],
        &["arm", "home"],
        &["memory", "compact"],
        &["memory", "repair"],
        &["memory", "verify"],
        &["knowledge", "put", "note", "/etc/hostname"],
        &["knowledge", "remove", "note"],
        &["model", "forget", "mug"],
    ] {
        let sentence = refused(&as_member(&sandbox, &folder, changing));
        assert!(sentence.contains("has the role of a reader"), "{sentence}");
    }
    // The only reason not to stop the arm is that there is none.
    let stop = refused(&as_member(&sandbox, &folder, &["arm", "stop"]));
    assert!(!stop.contains("role"), "{stop}");
    assert_eq!(
        daemon.ask(&["categories"])["categories"],
        Value::from(Vec::<u8>::new())
    );
    daemon.stop();
}

#[test]
#[ignore = "needs root"]
fn as_root_teacher_undoes_only_its_own_changes() {
    let sandbox = Sandbox::with_group(GROUP);
    let folder = program_for_all();
    let daemon = sandbox.start(&TABLE);
    let objects = wait_for_all(&daemon, 0);
    let (mug, bowl) = (id(&objects[0]), id(&objects[1]));
    let member = |arguments: &[&str]| as_member(&sandbox, &folder, arguments);
    daemon.ask(&["teach", &mug, "mug", "--author", "anna"]);
    allowed(&member(&["teach", &bowl, "bowl", "--author", "anna"]));

    let (by_root, by_nobody) = (entry_of(&daemon, 0), entry_of(&daemon, NOBODY));
    assert_eq!(by_root["author"], by_nobody["author"]);
    // A claimed author gives no rights.
    let others = by_root["sequence"].to_string();
    let sentence = refused(&member(&["undo", &others, "--author", "anna"]));
    assert!(sentence.contains("made by another user"), "{sentence}");
    allowed(&member(&["undo", "--author", "anna"]));
    let sentence = refused(&member(&["undo", "--author", "anna"]));
    assert!(sentence.contains("nothing to undo"), "{sentence}");
    daemon.ask(&["undo", "--author", "anna"]);
    allowed(&member(&["redo", "--author", "anna"]));
    let sentence = refused(&member(&["redo", "--author", "anna"]));
    assert!(sentence.contains("nothing to redo"), "{sentence}");
    let sentence = refused(&member(&["memory", "compact"]));
    assert!(sentence.contains("administrator"), "{sentence}");
    // A teacher uploads documents, and no memory.
    allowed(&member(&["knowledge", "put", "note", "/etc/hostname"]));
    let sentence = refused(&member(&["memory", "import", "/etc/hostname"]));
    assert!(sentence.contains("administrator"), "{sentence}");
    allowed(&member(&["undo", "--author", "anna"]));
    // The daemon's own user may undo what others did.
    allowed(&member(&["teach", &bowl, "bowl", "--author", "ben"]));
    daemon.ask(&["undo", "--author", "ben"]);
    daemon.stop();
}

/// Lesson of a user in the history.
fn entry_of(daemon: &Daemon<'_>, uid: u32) -> Value {
    let history = daemon.ask(&["memory", "history"]);
    let entries = history["entries"].as_array().unwrap();
    let is_lesson = |entry: &&Value| entry["uid"] == uid && entry["operation"] == "teach";
    entries.iter().find(is_lesson).unwrap().clone()
}

/// File modes: other users can read nothing of what is learned.
#[test]
fn learned_files_are_closed_to_other_users() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let track = id(&wait_for_all(&daemon, 0)[0]);
    daemon.ask(&["teach", &track, "mug"]);
    let mut folders = vec![
        sandbox.home().join("perceptual-memory"),
        sandbox.home().join("working-memory"),
    ];
    let mut n_files = 0;
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(&folder).unwrap() {
            let path = path.unwrap().path();
            let Ok(metadata) = std::fs::symlink_metadata(&path) else {
                continue;
            };
            let mode = metadata.permissions().mode();
            assert_eq!(mode & 0o077, 0, "{}: {mode:o}", path.display());
            n_files += 1;
            if metadata.is_dir() {
                folders.push(path);
            }
        }
        let mode = std::fs::metadata(&folder).unwrap().permissions().mode();
        assert_eq!(mode & 0o077, 0, "{}: {mode:o}", folder.display());
    }
    assert!(n_files > 4, "{n_files}");
    let export = sandbox.home().join("memory.export");
    daemon.ask(&["memory", "export", export.to_str().unwrap()]);
    let mode = std::fs::metadata(export).unwrap().permissions().mode();
    assert_eq!(mode & 0o077, 0, "{mode:o}");
    daemon.stop();
}

/// A client can neither forge a line of the history nor rewrite the terminal of its reader.
#[test]
fn control_characters_are_refused_in_every_text() {
    let sandbox = Sandbox::new();
    let daemon = sandbox.start(&TABLE);
    let track = id(&wait_for_all(&daemon, 0)[0]);
    let forged = "anna\u{1b}[2J\n99  2026-01-01 ben teach";
    for arguments in [
        &["teach", &track, "mug", "--author", forged][..],
        &["correct", &track, "mug", "--author", forged],
        &["undo", "--author", forged],
    ] {
        let (_, sentence) = daemon.refused(arguments);
        assert!(sentence.contains("U+001B"), "{arguments:?}: {sentence}");
        assert!(!sentence.contains('\u{1b}'), "{sentence:?}");
    }
    let folders = [sandbox.run_folder()];
    for (kind, parameters, author) in [
        (forged, "{}", "anna"),
        ("clear", forged, "anna"),
        ("clear", "{}", forged),
    ] {
        let (id, [kind, parameters, author]) =
            (MutationId(7), [kind, parameters, author].map(str::to_owned));
        let start = request::start_task(id, kind, parameters, author);
        match DaemonClient::ask_once(&sandbox.domain, &folders, WATCHDOG, &start) {
            Err(CallError::Refusal(refusal)) => assert_eq!(refusal.kind, RefusalKind::Invalid),
            other => panic!("{other:?}"),
        }
    }
    daemon.stop();
}
